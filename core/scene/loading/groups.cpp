#include "core/scene/loading/groups.h"

#include <algorithm>

#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

struct InstanceParameters {
    JsonNode toWorld;
    template <class V>
    void describe(V& v) {
        v("to_world", toWorld,
          {.help = "group to world: a matrix or a list of steps",
           .example = R"([{"type": "translate", "value": [0, 1, 0]}])"});
    }
};

/// The place of an instance, checked.
class Placement {
public:
    Placement(const JsonNode& node, const JsonNode& toWorld) : node_(node), toWorld_(toWorld), m_(parseTransform(toWorld)), scale_(uniformScale(m_)) {
        for (size_t i = 0; i < 4; ++i) rounded_[i] = Vec3f(float(m_[int(i)][0]), float(m_[int(i)][1]), float(m_[int(i)][2]));
        const Vec3d x(rounded_[0]), y(rounded_[1]), z(rounded_[2]);
        // Beyond this the ray tracer's own inverse, in single precision, is not finite, or the sign of the volume is rounding.
        const double sizes[3] = {x.length(), y.length(), z.length()};
        for (const double size : sizes)
            if (!(size > 1e-9 && size < 1e9)) toWorld_.fail("an instance must not be scaled by less than 1e-9 or more than 1e9");
        if (!(std::abs(x.dot(y.cross(z))) > 1e-6 * sizes[0] * sizes[1] * sizes[2]))
            toWorld_.fail("the transformation of an instance is too near to one that cannot be inverted");
    }

    Shape operator()(const Shape& member) const {
        Shape shape = member;
        std::visit([&](auto& geometry) { place(geometry, member.id); }, shape.geometry);
        const Imath::Box3f box = shape.bounds();
        for (int i = 0; i < 3; ++i)
            if (!(std::max(std::abs(box.min[i]), std::abs(box.max[i])) <= kLargestCoordinate))
                node_.fail(fmt::format("the instance reaches beyond {:g}", kLargestCoordinate));
        return shape;
    }

private:
    void place(Mesh&, const std::string&) const {}  // none in a group: they are shared
    void place(MeshInstance& instance, const std::string&) const { instance.toWorld = rounded_; }
    void place(Disk& disk, const std::string&) const {
        disk.center = point(disk.center);
        disk.axisX = Vec3f(vector(disk.axisX));
        disk.axisY = Vec3f(vector(disk.axisY));
        Vec3d normal;
        m_.inverse().transposed().multDirMatrix(Vec3d(disk.normal), normal);
        disk.normal = Vec3f(normal.normalized());
    }
    void place(Sphere& sphere, const std::string& id) const {
        sphere.center = point(sphere.center);
        placeRound(sphere, id);
    }
    void place(Cylinder& cylinder, const std::string& id) const {
        cylinder.base = point(cylinder.base);
        placeRound(cylinder, id);
        cylinder.length *= float(std::abs(*scale_));
    }
    template <class G>
    void placeRound(G& geometry, const std::string& id) const {
        if (!scale_)
            toWorld_.fail(fmt::format("{} of the group must stay round: rotations, translations, mirrors and uniform scale only", inQuotes(id)),
                          "make it a mesh, or scale it in the group");
        geometry.radius *= float(std::abs(*scale_));
        if (!(geometry.radius > 1 / kLargestCoordinate)) node_.fail(fmt::format("the radius of {} is below 1/{:g}", inQuotes(id), kLargestCoordinate));
        for (Vec3f& axis : geometry.axes) axis = Vec3f(vector(axis).normalized());
    }

    Vec3f point(const Vec3f& p) const {
        Vec3d out;
        m_.multVecMatrix(Vec3d(p), out);
        return Vec3f(out);
    }
    Vec3d vector(const Vec3f& v) const {
        Vec3d out;
        m_.multDirMatrix(Vec3d(v), out);
        return out;
    }

    const JsonNode &node_, &toWorld_;
    Matrix4 m_;
    std::optional<double> scale_;
    std::array<Vec3f, 4> rounded_;
};

}  // namespace

std::vector<PluginInfo> groupPlugins() {
    return {{"instance", "a shape group (nested, or a reference) at a place of its own", parameterInfo<InstanceParameters>()},
            {"shapegroup", "nested shapes, invisible by themselves, for instances to place", {}}};
}

std::vector<Shape> makeGroup(std::vector<Shape> members) {
    std::stable_partition(members.begin(), members.end(), [](const Shape& s) { return std::holds_alternative<Mesh>(s.geometry); });
    uint32_t meshes = 0;
    for (Shape& shape : members) {
        Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
        if (!mesh) break;
        shape.geometry = MeshInstance{std::make_shared<const Mesh>(std::move(*mesh)), meshes++};
    }
    return members;
}

std::vector<Shape> readInstance(const JsonNode& node, const std::vector<Shape>& group) {
    const auto p = parsePlugin<InstanceParameters>(node);
    const Placement place(node, p.toWorld);
    std::vector<Shape> shapes;
    for (const Shape& member : group) {
        shapes.push_back(place(member));
        shapes.back().id = fmt::format("{}/{}", node.key(), member.id);
    }
    return shapes;
}

}  // namespace ulam
