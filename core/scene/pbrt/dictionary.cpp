#include "core/scene/pbrt/dictionary.h"

#include <fmt/format.h>

#include "core/config/json_text.h"
#include "core/config/suggest.h"

namespace ulam::pbrt {

std::string Dictionary::name(const std::string& wanted) {
    std::string unique = wanted.empty() || wanted[0] == '$' ? "_" + wanted : wanted;
    const std::string stem = unique;
    int& count = counters_[stem];
    while (!names_.insert(unique).second) unique = fmt::format("{}_{}", stem, ++count + 1);
    return unique;
}

void Dictionary::add(const std::string& entry, Json plugin, const Place& place) {
    places_.emplace_back('/' + escapePointerStep(entry), place.text());
    // Names are never the same twice, so nothing need be looked for.
    scene_.get_ref<Json::object_t&>().emplace_back(entry, std::move(plugin));
}

void Dictionary::note(const std::string& entry, const std::string& key, const Place& place) {
    places_.emplace_back('/' + escapePointerStep(entry) + '/' + escapePointerStep(key), place.text());
}

void Dictionary::unknown(std::string_view kind, const std::string& type, const std::vector<std::string>& known,
                         const Place& place, std::string_view instead) {
    if (!lenient) unknownName(kind, type, known, place.text());
    substitute(fmt::format("the {} {} at {} is not known: {}", kind, inQuotes(type), place.text(), instead));
}

void Dictionary::unsupported(const std::string& what, const Place& place, std::string_view hint,
                             std::string_view instead) {
    if (!lenient) refuse(place, what + " is not supported", hint);
    substitute(fmt::format("{} at {} is not supported: {}", what, place.text(), instead));
}

JsonDocument Dictionary::document(std::string file, const Place& whole) {
    places_.insert(places_.begin(), {"", whole.text()});
    if (!substitutions_.empty()) scene_["$substitutions"] = substitutions_;
    return JsonDocument::fromParts(std::move(scene_), std::move(file), std::move(places_));
}

Json colourJson(const Spectrum& colour) {
    if (colour.x == colour.y && colour.y == colour.z) return colour.x;
    return {colour.x, colour.y, colour.z};
}

Json matrixJson(const Matrix4& m) {
    Json rows = Json::array();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) rows.push_back(m[column][row]);
    return rows;
}

}  // namespace ulam::pbrt
