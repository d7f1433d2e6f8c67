#include "core/config/difference.h"

#include <fmt/format.h>

namespace ulam {

std::string firstDifference(const Json& stored, const Json& wanted, std::string_view place) {
    const Json step = Json::diff(stored, wanted).at(0);
    const Json::json_pointer pointer(step["path"].get<std::string>());
    const auto at = [&](const Json& document) {
        return document.contains(pointer) ? document[pointer].dump() : std::string("not given");
    };
    return fmt::format("{} is {}, {} in {}", pointer.to_string(), at(wanted), at(stored), place);
}

}  // namespace ulam
