#include "core/scene/pbrt/instances.h"

#include <fmt/format.h>

#include "core/config/suggest.h"

namespace ulam::pbrt {
void Instances::begin(const std::string& name, const Place& place) {
    if (open_) refuse(place, "ObjectBegin stands inside another ObjectBegin");
    const auto [object, isNew] = objects_.emplace(name, Object{{}, "", place});
    if (!isNew) refuse(place, fmt::format("another object is called {}", inQuotes(name)));
    open_ = &object->second;
}

void Instances::place(const std::string& name, const Matrix4& toWorld, const Place& place) {
    if (open_) refuse(place, "ObjectInstance stands inside ObjectBegin");
    instances_.push_back({name, toWorld, place});
}

void Instances::refer(Object& object, const Instance& instance) {
    if (object.entry.empty()) {
        Json group = {{"type", "shapegroup"}};
        int number = 0;
        for (const ShapeRecord& shape : object.shapes)
            group[fmt::format("shape_{}", ++number)] = shapeEntry(shape, {}, materials_);
        object.entry = dictionary_.name(instance.object);
        dictionary_.add(object.entry, std::move(group), object.place);
    }
    Json entry = {{"type", "instance"},
                  {"shapegroup", {{"type", "ref"}, {"id", object.entry}}},
                  {"to_world", matrixJson(instance.toWorld)}};
    dictionary_.add(dictionary_.name("instance"), std::move(entry), instance.place);
}

void Instances::finish() {
    for (const Instance& instance : instances_) {
        const auto found = objects_.find(instance.object);
        if (found == objects_.end()) {
            std::vector<std::string> names;
            for (const auto& object : objects_) names.push_back(object.first);
            unknownName("object", instance.object, names, instance.place.text());
        }
        if (!found->second.shapes.empty()) refer(found->second, instance);
    }
}

}  // namespace ulam::pbrt
