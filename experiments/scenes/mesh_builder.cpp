#include "experiments/scenes/mesh_builder.h"

namespace ulam {

size_t MeshBuilder::vertex(const Vec3d& p) {
    const auto [place, isNew] = vertices_.try_emplace({p.x, p.y, p.z}, positions_.size() / 3);
    if (isNew) positions_.insert(positions_.end(), {p.x, p.y, p.z});
    return place->second;
}

void MeshBuilder::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    triangles_.insert(triangles_.end(), {vertex(a), vertex(b), vertex(c)});
}

void MeshBuilder::quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    triangle(a, b, c);
    triangle(a, c, d);
}

void MeshBuilder::polygon(const std::vector<Vec3d>& corners) {
    for (size_t i = 2; i < corners.size(); ++i) triangle(corners[0], corners[i - 1], corners[i]);
}

Json MeshBuilder::shape(const Json& bsdf) const {
    return {{"type", "mesh"}, {"positions", positions_}, {"triangles", triangles_}, {"bsdf", bsdf}};
}

Json diffuse(double reflectance) {
    return {{"type", "diffuse"}, {"reflectance", reflectance}};
}

Json areaEmitter(double radiance) {
    return {{"type", "area"}, {"radiance", radiance}};
}

Json emitting(Json shape, double radiance) {
    shape["bsdf"] = diffuse(0);
    shape["emitter"] = areaEmitter(radiance);
    return shape;
}

}  // namespace ulam
