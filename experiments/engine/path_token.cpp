#include "experiments/engine/path_token.h"

#include <zlib.h>

#include <algorithm>

#include "core/base/error.h"

namespace ulam {
namespace {

// RFC 4648, §5, without padding.
constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr std::string_view kPrefix = "path1-";
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

std::string pathToken(const RunIdentity& run, const Json& repeat, const NonFiniteEvent& event) {
    const std::string text = Json{{"repeat", repeat},
                                  {"scene_hash", run.sceneHash},
                                  {"key", {run.key.low, run.key.high}},
                                  {"kind", int(event.kind)},
                                  {"unit", event.unit},
                                  {"chain", event.chain},
                                  {"step", event.step},
                                  {"cause", event.cause}}
                                 .dump();
    uLongf size = compressBound(uLong(text.size()));
    std::string packed(size, '\0');
    compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(text.data()), uLong(text.size()), 9);
    packed.resize(size);
    return std::string(kPrefix) + toWord(packed);
}

PathToken readPathToken(const std::string& token) {
    if (!token.starts_with(kPrefix)) fail(ExitCode::Usage, "expected a token that begins with {}, as results and messages have them", kPrefix);
    const std::string packed = fromWord(std::string_view(token).substr(kPrefix.size()));
    std::string text;
    int outcome = Z_BUF_ERROR;
    for (uLongf size = 1 << 16; outcome == Z_BUF_ERROR && size <= kLargest; size *= 4) {
        text.resize(size);
        uLongf used = size;
        outcome = uncompress(reinterpret_cast<Bytef*>(text.data()), &used, reinterpret_cast<const Bytef*>(packed.data()), uLong(packed.size()));
        if (outcome == Z_OK) text.resize(used);
    }
    if (packed.empty() || outcome != Z_OK) fail(ExitCode::Usage, "the token is not complete");
    const JsonDocument document = JsonDocument::fromText(text, "the token");
    const JsonNode root = document.root();
    const auto key = root.at("key").elements();
    if (key.size() != 2) root.at("key").expected("two numbers");
    const int64_t kind = root.at("kind").integer();
    if (kind < 0 || kind > int(NonFiniteEvent::Kind::Step)) root.at("kind").expected("a number from 0 to 3");
    return {.repeat = root.at("repeat").json(),
            .sceneHash = root.at("scene_hash").string(),
            .key = {uint32_t(key[0].unsignedInteger()), uint32_t(key[1].unsignedInteger())},
            .event = {.kind = NonFiniteEvent::Kind(kind),
                      .unit = root.at("unit").unsignedInteger(),
                      .chain = uint32_t(root.at("chain").unsignedInteger()),
                      .step = root.at("step").unsignedInteger(),
                      .cause = root.at("cause").string()}};
}

}  // namespace ulam
