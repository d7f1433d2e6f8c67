#include "experiments/engine/token.h"

#include <zlib.h>

#include "core/base/error.h"

namespace ulam {
namespace {

// RFC 4648, §5, without padding.
constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr uLong kLargest = 1 << 24;

std::string toWord(std::string_view bytes) {
    std::string word;
    uint32_t bits = 0;
    int count = 0;
    for (const char c : bytes) {
        bits = bits << 8 | uint8_t(c);
        for (count += 8; count >= 6; count -= 6) word += kDigits[bits >> (count - 6) & 63];
    }
    if (count > 0) word += kDigits[bits << (6 - count) & 63];
    return word;
}

std::string fromWord(std::string_view word) {
    std::string bytes;
    uint32_t bits = 0;
    int count = 0;
    for (const char c : word) {
        const size_t digit = kDigits.find(c);
        if (digit == kDigits.npos) return {};
        bits = bits << 6 | uint32_t(digit);
        if ((count += 6) >= 8) bytes += char(bits >> (count -= 8) & 255);
    }
    return bytes;
}

}  // namespace

std::string packToken(std::string_view prefix, const Json& content) {
    const std::string text = content.dump();
    uLongf size = compressBound(uLong(text.size()));
    std::string packed(size, '\0');
    compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(text.data()), uLong(text.size()), 9);
    packed.resize(size);
    return std::string(prefix) + toWord(packed);
}

JsonDocument unpackToken(std::string_view prefix, const std::string& token) {
    if (!token.starts_with(prefix)) fail(ExitCode::Usage, "expected a token that begins with {}, as results and messages have them", prefix);
    const std::string packed = fromWord(std::string_view(token).substr(prefix.size()));
    std::string text;
    int outcome = Z_BUF_ERROR;
    for (uLongf size = 1 << 16; outcome == Z_BUF_ERROR && size <= kLargest; size *= 4) {
        text.resize(size);
        uLongf used = size;
        outcome = uncompress(reinterpret_cast<Bytef*>(text.data()), &used, reinterpret_cast<const Bytef*>(packed.data()), uLong(packed.size()));
        if (outcome == Z_OK) text.resize(used);
    }
    if (packed.empty() || outcome != Z_OK) fail(ExitCode::Usage, "the token is not complete");
    return JsonDocument::fromText(text, "the token");
}

}  // namespace ulam
