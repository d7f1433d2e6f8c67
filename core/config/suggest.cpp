#include "core/config/suggest.h"

#include <algorithm>
#include <cctype>

#include "core/base/error.h"
#include "core/config/json.h"

namespace ulam {
namespace {

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// Optimal string alignment distance: insertions, deletions, replacements and swaps of neighbours.
std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> beforeLast, last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            const bool swapped =
                i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], beforeLast[j - 2] + 1);
        }
        beforeLast = last;
        last = row;
    }
    return last[b.size()];
}

}  // namespace

std::string nearestName(std::string_view name, const std::vector<std::string>& candidates) {
    std::string nearest;
    std::size_t fewest = 0;
    for (const std::string& candidate : candidates) {
        const std::size_t shorter = std::min(name.size(), candidate.size());
        const std::size_t longer = std::max(name.size(), candidate.size());
        const std::size_t limit = std::max<std::size_t>(1, longer / 3);
        if (shorter == 0 || longer - shorter > limit) continue;
        const std::size_t edits = editDistance(name, candidate);
        if (edits > limit || edits >= longer || (!nearest.empty() && edits >= fewest)) continue;
        nearest = candidate;
        fewest = edits;
    }
    return nearest;
}

std::string didYouMean(std::string_view name, const std::vector<std::string>& candidates) {
    const std::string nearest = nearestName(name, candidates);
    return nearest.empty() ? "" : fmt::format("did you mean {}?", inQuotes(nearest));
}

void unknownName(std::string_view kind, std::string_view name, const std::vector<std::string>& candidates,
                 std::string_view where) {
    std::string message = fmt::format("unknown {} {} at {}; ", kind, inQuotes(name), where);
    if (const std::string hint = didYouMean(name, candidates); !hint.empty()) message += hint + ' ';
    message += candidates.empty() ? "None is known" : "Known: " + listInQuotes(candidates);
    throw Error(ExitCode::InvalidConfig, message);
}

std::string printable(std::string_view text, std::size_t limit) {
    const auto startsCharacter = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
    std::size_t length = std::min(limit, text.size());
    while (length < text.size() && length > 0 && !startsCharacter(text[length])) --length;
    // Through JSON and back: what is not UTF-8 becomes U+FFFD.
    const std::string json = Json(text.substr(0, length)).dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string result;
    for (const char c : Json::parse(json).get<std::string>()) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '\n')
            result += "\\n";
        else if (byte < 0x20 || byte == 0x7F)
            result += fmt::format("\\u{:04x}", byte);
        else
            result += c;
    }
    return length < text.size() ? result + "…" : result;
}

std::string inQuotes(std::string_view text) {
    return '"' + printable(text) + '"';
}

std::string listInQuotes(const std::vector<std::string>& names) {
    std::string result;
    for (const std::string& name : names) result += (result.empty() ? "" : ", ") + inQuotes(name);
    return result;
}

}  // namespace ulam
