#pragma once
// Objects that are placed many times: groups of shapes and their instances.

#include "core/scene/pbrt/shapes.h"

namespace ulam::pbrt {

class Instances {
public:
    Instances(Dictionary& dictionary, Materials& materials) : dictionary_(dictionary), materials_(materials) {}

    /// ObjectBegin and ObjectEnd; shapes in between are added to the object.
    void begin(const std::string& name, const Place& place);
    void end() { open_ = nullptr; }
    bool isOpen() const { return open_ != nullptr; }
    void add(ShapeRecord shape) { open_->shapes.push_back(std::move(shape)); }
    /// ObjectInstance: the object moved once more.
    void place(const std::string& name, const Matrix4& toWorld, const Place& place);

    /// Entries for all instances, once materials are known.
    void finish();

private:
    struct Object {
        std::vector<ShapeRecord> shapes;
        std::string entry;  ///< of the group, once it is there
        Place place;
    };
    struct Instance {
        std::string object;
        Matrix4 toWorld;
        Place place;
    };

    void refer(Object& object, const Instance& instance);

    Dictionary& dictionary_;
    Materials& materials_;
    std::map<std::string, Object> objects_;
    Object* open_ = nullptr;
    std::vector<Instance> instances_;
};

}  // namespace ulam::pbrt
