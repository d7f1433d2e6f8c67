#pragma once
// Tokens: JSON packed into one word of letters, digits, '-' and '_', after a prefix that says what it is of.

#include "core/config/json.h"

namespace ulam {

std::string packToken(std::string_view prefix, const Json& content);
/// Fails with Usage where the word is no token with this prefix, or a damaged one.
JsonDocument unpackToken(std::string_view prefix, const std::string& token);

}  // namespace ulam
