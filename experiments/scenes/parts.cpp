#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kLeastAlpha = 1e-4;

double radians(double degrees) {
    return degrees * kPi / 180;
}

Json lookAt(const Vec3d& origin, const Vec3d& target, const Vec3d& up) {
    return {{"type", "lookat"}, {"origin", triple(origin)}, {"target", triple(target)}, {"up", triple(up)}};
}

}  // namespace

Json triple(const Vec3d& v) {
    return Json::array({v.x, v.y, v.z});
}

Json View::sensor() const {
    return {{"type", "perspective"},
            {"fov", fov},
            {"to_world", Json::array({lookAt(origin, target, up)})},
            {"film", {{"type", "hdrfilm"}, {"width", width}, {"height", height}, {"rfilter", {{"type", "box"}}}}}};
}

Json diffuse(const Spectrum& reflectance) {
    return {{"type", "diffuse"}, {"reflectance", triple(reflectance)}};
}

Json twosided(const Json& bsdf) {
    return {{"type", "twosided"}, {"bsdf", bsdf}};
}

Json glass(double alpha, double ior) {
    Json bsdf = {{"type", alpha < kLeastAlpha ? "dielectric" : "roughdielectric"}, {"int_ior", ior}, {"ext_ior", 1.0}};
    if (alpha >= kLeastAlpha) bsdf["alpha"] = alpha;
    return bsdf;
}

Json metal(const char* material, double alpha) {
    Json bsdf = {{"type", alpha < kLeastAlpha ? "conductor" : "roughconductor"}, {"material", material}};
    if (alpha >= kLeastAlpha) bsdf["alpha"] = alpha;
    return bsdf;
}

Json sphere(const Vec3d& center, double radius, const Json& bsdf) {
    return {{"type", "sphere"}, {"center", triple(center)}, {"radius", radius}, {"bsdf", bsdf}};
}

Json tube(const Vec3d& p0, const Vec3d& p1, double radius, const Json& bsdf) {
    return {{"type", "cylinder"}, {"p0", triple(p0)}, {"p1", triple(p1)}, {"radius", radius}, {"bsdf", twosided(bsdf)}};
}

Json disk(const Vec3d& center, const Vec3d& target, double radius) {
    const Vec3d axis = (target - center).normalized();
    const Vec3d up = std::abs(axis.y) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0);
    return {{"type", "disk"}, {"to_world", Json::array({{{"type", "scale"}, {"value", radius}}, lookAt(center, target, up)})}};
}

Json discLight(const Vec3d& center, const Vec3d& target, double width, double irradiance) {
    const double half = radians(width / 2), sine = std::sin(half);
    return emitting(disk(center, target, (target - center).length() * std::tan(half)), irradiance / (kPi * sine * sine));
}

Json emitting(Json shape, const Spectrum& radiance) {
    shape["bsdf"] = diffuse(0);
    shape["emitter"] = {{"type", "area"}, {"radiance", triple(radiance)}};
    return shape;
}

}  // namespace ulam
