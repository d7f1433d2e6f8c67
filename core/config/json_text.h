#pragma once
// Positions in a JSON text. Nothing is stored while parsing: messages are rare, so the text is scanned again for them.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// Walks over the tokens of a text whose syntax is known to be right up to where it stands.
class TokenCursor {
public:
    explicit TokenCursor(std::string_view text);
    /// Steps over blanks, comments, commas and colons and then over one token: a bracket, a string, a number or a word.
    /// Returns where the token starts.
    std::size_t next();
    /// Where the last token ends.
    std::size_t end() const { return end_; }

private:
    void skipSeparators();

    std::string_view text_;
    std::size_t end_ = 0;
};

/// Where the value under these names and indices starts in a valid text.
std::optional<std::size_t> locate(std::string_view text, const std::vector<std::string>& steps);

TextPosition positionAt(std::string_view text, std::size_t offset);

/// "file:line:column"
std::string placeOf(std::string_view name, std::string_view text, std::size_t offset);

/// The value of a text of any length, with the other refusals of JsonDocument; `name` stands for the file in messages.
Json parseJson(std::string_view text, std::string_view name);

/// One step of a JSON pointer with "~" and "/" escaped, and the steps of a whole pointer unescaped (RFC 6901).
std::string escapePointerStep(std::string_view step);
std::vector<std::string> pointerSteps(std::string_view pointer);

}  // namespace ulam
