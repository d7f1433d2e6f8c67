#include "core/scene/pbrt/instances.h"

#include <fmt/format.h>

#include "core/config/suggest.h"
#include "core/scene/loading/plugin_table.h"

namespace ulam::pbrt {
namespace {

constexpr double kMostCopies = 5e5;         // shapes of all instances
constexpr double kMostCopiedNumbers = 5e7;  // coordinates of their meshes

}  // namespace

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

void Instances::copy(const Object& object, const Instance& instance) {
    for (const ShapeRecord& shape : object.shapes) {
        ++copies_;
        numbers_ +=
            double(shape.positions.size() + shape.normals.size() + shape.texcoords.size() + shape.indices.size());
        if (copies_ > kMostCopies || numbers_ > kMostCopiedNumbers)
            refuse(instance.place, fmt::format("all instances together hold more than {:g} shapes or {:g} coordinates",
                                               kMostCopies, kMostCopiedNumbers));
        Json entry = shapeEntry(shape, instance.toWorld, materials_);
        dictionary_.add(dictionary_.name("shape"), std::move(entry), instance.place);
    }
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
    const bool hasGroups = contains(scenePlugins(PluginKind::Shapes), "instance");
    for (const Instance& instance : instances_) {
        const auto found = objects_.find(instance.object);
        if (found == objects_.end()) {
            std::vector<std::string> names;
            for (const auto& object : objects_) names.push_back(object.first);
            unknownName("object", instance.object, names, instance.place.text());
        }
        if (found->second.shapes.empty()) continue;
        if (hasGroups)
            refer(found->second, instance);
        else
            copy(found->second, instance);
    }
}

}  // namespace ulam::pbrt
