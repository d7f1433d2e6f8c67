#include "core/scene/pbrt/tokens.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/error.h"
#include "core/config/json.h"
#include "core/config/suggest.h"

namespace ulam::pbrt {
namespace {

constexpr std::string_view kBlanks = " \t\r\n", kEnds = " \t\r\n\"[]#";

}  // namespace

SourceFile::SourceFile(std::string fileName, std::string_view text) : name(std::move(fileName)), lines{0} {
    for (size_t i = 0; i < text.size(); ++i)
        if (text[i] == '\n') lines.push_back(i + 1);
}

std::string Place::text() const {
    const auto line = std::upper_bound(file->lines.begin(), file->lines.end(), offset) - file->lines.begin();
    return fmt::format("{}:{}:{}", file->name, line, offset - file->lines[size_t(line - 1)] + 1);
}

void refuse(const Place& place, std::string_view message, std::string_view hint) {
    fail(ExitCode::InvalidConfig, "{} at {}{}{}", message, place.text(), hint.empty() ? "" : "; ", hint);
}

Token Tokens::read() {
    while (true) {
        at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
        if (at_ == text_.size() || text_[at_] != '#') break;
        at_ = std::min(text_.find('\n', at_), text_.size());
    }
    const size_t begin = at_;
    if (begin == text_.size()) return {Token::Kind::End, {}, begin};
    if (text_[begin] == '[' || text_[begin] == ']') {
        ++at_;
        return {text_[begin] == '[' ? Token::Kind::Open : Token::Kind::Close, text_.substr(begin, 1), begin};
    }
    if (text_[begin] != '"') {
        at_ = std::min(text_.find_first_of(kEnds, begin), text_.size());
        return {Token::Kind::Word, text_.substr(begin, at_ - begin), begin};
    }
    for (size_t end = begin + 1; end < text_.size() && text_[end] != '\n'; ++end) {
        if (text_[end] == '"') {
            at_ = end + 1;
            return {Token::Kind::Text, text_.substr(begin + 1, end - begin - 1), begin};
        }
        if (text_[end] == '\\') ++end;
    }
    refuse({&file_, begin}, "the text has no closing quote on its line");
}

Token Tokens::next() {
    if (!peeked_) return read();
    const Token token = *peeked_;
    peeked_.reset();
    return token;
}

const Token& Tokens::peek() {
    if (!peeked_) peeked_ = read();
    return *peeked_;
}

void Tokens::unexpected(const Token& token, std::string_view expected) const {
    const std::string found = token.kind == Token::Kind::End ? "the end of the file" : inQuotes(token.text);
    refuse(place(token), fmt::format("expected {}, found {}", expected, found));
}

std::string Tokens::textOf(const Token& token) const {
    std::string result;
    for (size_t i = 0; i < token.text.size(); ++i) {
        char c = token.text[i];
        if (c == '\\' && i + 1 < token.text.size()) {
            c = token.text[++i];
            if (c == 'n') c = '\n';
            if (c == 't') c = '\t';
        }
        result += c;
    }
    if (!isUtf8(result)) refuse(place(token), fmt::format("the text {} is not UTF-8", inQuotes(result)));
    return result;
}

double Tokens::numberOf(const Token& token, std::string_view what) const {
    double value = 0;
    const char *begin = token.text.data(), *end = begin + token.text.size();
    if (token.text.starts_with('+')) ++begin;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (token.kind != Token::Kind::Word || error != std::errc() || stop != end || !std::isfinite(value))
        unexpected(token, fmt::format("a number for {}", what));
    return value;
}

std::string Tokens::text(std::string_view what) {
    const Token token = next();
    if (token.kind != Token::Kind::Text) unexpected(token, fmt::format("{} in quotes", what));
    return textOf(token);
}

double Tokens::number(std::string_view what) {
    return numberOf(next(), what);
}

}  // namespace ulam::pbrt
