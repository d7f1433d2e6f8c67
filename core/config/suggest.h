#pragma once
// Names users type, and what they probably meant.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ulam {

/// The candidate with the fewest edits (insert, delete, replace, swap of neighbours; case ignored) from `name`; empty
/// if that takes more than a third of the longer name. Of equals the first.
std::string nearestName(std::string_view name, const std::vector<std::string>& candidates);

/// Throws InvalidConfig: `unknown mutation "lense" at a.json:3:9 (/mutations/lense); did you mean "lens"? Known: …`.
[[noreturn]] void unknownName(std::string_view kind, std::string_view name, const std::vector<std::string>& candidates,
                              std::string_view where);

/// "did you mean "lens"?", or empty if nothing is near.
std::string didYouMean(std::string_view name, const std::vector<std::string>& candidates);

/// The text on one line and cut after about `limit` bytes, for messages: control characters become
/// escapes, bytes that are not UTF-8 become U+FFFD.
std::string printable(std::string_view text, std::size_t limit = 80);
/// The same in double quotes.
std::string inQuotes(std::string_view text);
/// Every name in quotes, separated by commas.
std::string listInQuotes(const std::vector<std::string>& names);

}  // namespace ulam
