#pragma once
// The words of a pbrt file and where they stand.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ulam::pbrt {

/// A file's name and where its lines begin; its text need not live as long.
struct SourceFile {
    SourceFile(std::string fileName, std::string_view text);

    std::string name;
    std::vector<size_t> lines;
};

struct Place {
    const SourceFile* file = nullptr;
    size_t offset = 0;

    /// "scene.pbrt:3:5"
    std::string text() const;
};

/// "<message> at <place>; <hint>", as InvalidConfig.
[[noreturn]] void refuse(const Place& place, std::string_view message, std::string_view hint = {});

struct Token {
    enum class Kind { Word, Text, Open, Close, End };
    Kind kind;
    std::string_view text;  ///< of a text: what stands between the quotes
    size_t offset;
};

/// Words, texts in quotes and brackets; remarks from # to the end of a line are skipped.
class Tokens {
public:
    Tokens(std::string_view text, const SourceFile& file) : text_(text), file_(file) {}

    Token next();
    const Token& peek();
    Place place(const Token& token) const { return {&file_, token.offset}; }

    /// The next token as a text or a finite number; `what` says in messages what it is for.
    std::string text(std::string_view what);
    double number(std::string_view what);
    /// A text's value, its escapes (\" \\ \n \t) replaced; other bytes must be UTF-8.
    std::string textOf(const Token& token) const;
    double numberOf(const Token& token, std::string_view what) const;
    [[noreturn]] void unexpected(const Token& token, std::string_view expected) const;

private:
    Token read();

    std::string_view text_;
    const SourceFile& file_;
    size_t at_ = 0;
    std::optional<Token> peeked_;
};

}  // namespace ulam::pbrt
