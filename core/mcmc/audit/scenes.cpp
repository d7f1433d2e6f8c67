#include "core/mcmc/audit/scenes.h"

#include "core/scene/load.h"

namespace ulam::audit {
namespace {

constexpr int kFilmSize = 32;

Json translate(double x, double y, double z) {
    return {{"type", "translate"}, {"value", {x, y, z}}};
}
Json rotate(const char axis, double degrees) {
    return {{"type", "rotate"},
            {"axis", {double(axis == 'x'), double(axis == 'y'), double(axis == 'z')}},
            {"angle", degrees}};
}
Json scale(double x, double y, double z) {
    return {{"type", "scale"}, {"value", {x, y, z}}};
}
Json diffuse(double r, double g, double b) {
    return {{"type", "diffuse"}, {"reflectance", {r, g, b}}};
}
Json shape(const char* type, std::vector<Json> steps, Json bsdf) {
    return {{"type", type}, {"to_world", steps}, {"bsdf", std::move(bsdf)}};
}
Json sphere(double x, double y, double z, double radius, Json bsdf) {
    return {{"type", "sphere"}, {"center", {x, y, z}}, {"radius", radius}, {"bsdf", std::move(bsdf)}};
}

Json camera(double x, double y, double z, double fov) {
    return {
        {"type", "perspective"},
        {"fov", fov},
        {"to_world",
         Json::array({{{"type", "lookat"}, {"origin", {x, y, z}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}}})},
        {"film", {{"type", "hdrfilm"}, {"width", kFilmSize}, {"height", kFilmSize}, {"rfilter", {{"type", "box"}}}}}};
}

/// A room of the size 2 × 2 × 2 without its front, lit from the ceiling.
Json box() {
    Json scene = {{"type", "scene"}, {"sensor", camera(0, 0, 3.7, 39)}};
    scene["back"] = shape("rectangle", {translate(0, 0, -1)}, diffuse(0.7, 0.7, 0.65));
    scene["floor"] = shape("rectangle", {rotate('x', -90), translate(0, -1, 0)}, diffuse(0.7, 0.7, 0.7));
    scene["ceiling"] = shape("rectangle", {rotate('x', 90), translate(0, 1, 0)}, diffuse(0.6, 0.6, 0.6));
    scene["left"] = shape("rectangle", {rotate('y', 90), translate(-1, 0, 0)}, diffuse(0.6, 0.1, 0.1));
    scene["right"] = shape("rectangle", {rotate('y', -90), translate(1, 0, 0)}, diffuse(0.1, 0.5, 0.1));
    scene["light"] =
        shape("rectangle", {scale(0.5, 0.5, 1), rotate('x', 90), translate(0, 0.98, 0.1)}, diffuse(0, 0, 0));
    scene["light"]["emitter"] = {{"type", "area"}, {"radiance", {5, 4.5, 4}}};
    return scene;
}

Json block(Json bsdf) {
    return shape("cube", {scale(0.3, 0.5, 0.3), rotate('y', 20), translate(0.4, -0.5, -0.35)}, std::move(bsdf));
}

Json diffuseBox() {
    Json scene = box();
    scene["block"] = block(diffuse(0.5, 0.5, 0.7));
    return scene;
}

Json specularBox() {
    Json scene = box();
    scene["mirror"] = block({{"type", "conductor"}});
    scene["glass"] = sphere(-0.35, -0.55, 0.25, 0.4, {{"type", "dielectric"}});
    // Radiance inside glass is scaled by its index. Light that comes in and leaves again does not show it; a lamp does.
    scene["core"] = sphere(-0.45, -0.6, 0.2, 0.17, diffuse(0.8, 0.7, 0.3));
    scene["bulb"] = sphere(-0.17, -0.55, 0.35, 0.14, diffuse(0, 0, 0));
    scene["bulb"]["emitter"] = {{"type", "area"}, {"radiance", {1, 1.1, 1.2}}};
    return scene;
}

/// An icosahedron shaded like the sphere around it.
Json smoothSolid(double radius, Json bsdf) {
    const double golden = (1 + std::sqrt(5.0)) / 2, unit = 1 / std::sqrt(1 + golden * golden);
    std::vector<double> normals, positions;
    for (int axis = 0; axis < 3; ++axis)
        for (double a : {-1.0, 1.0})
            for (double b : {-golden, golden}) {
                std::array<double, 3> v{};
                v[size_t(axis + 1) % 3] = a * unit, v[size_t(axis + 2) % 3] = b * unit;
                normals.insert(normals.end(), v.begin(), v.end());
            }
    for (double x : normals) positions.push_back(x * radius);
    const auto corner = [&](size_t i) { return Vec3d(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]); };
    std::vector<int> triangles;
    const double edge = 2.01 * unit;
    for (size_t i = 0; i < 12; ++i)
        for (size_t j = i + 1; j < 12; ++j)
            for (size_t k = j + 1; k < 12; ++k) {
                const Vec3d a = corner(i), b = corner(j), c = corner(k);
                if ((a - b).length() > edge || (b - c).length() > edge || (a - c).length() > edge) continue;
                const bool outwards = (b - a).cross(c - a).dot(a) > 0;
                for (size_t n : {i, outwards ? j : k, outwards ? k : j}) triangles.push_back(int(n));
            }
    return {{"type", "mesh"},
            {"positions", positions},
            {"normals", normals},
            {"triangles", triangles},
            {"bsdf", std::move(bsdf)}};
}

Json outdoors() {
    Json scene = {{"type", "scene"}, {"sensor", camera(0, 1.4, 4, 40)}};
    scene["ground"] =
        shape("rectangle", {scale(2.5, 2.5, 1), rotate('x', -90), translate(0, -0.7, 0)}, diffuse(0.6, 0.5, 0.4));
    scene["solid"] = smoothSolid(0.6, {{"type", "twosided"}, {"bsdf", diffuse(0.7, 0.3, 0.3)}});
    scene["ball"] = sphere(1.0, -0.35, 0.3, 0.35, diffuse(0.3, 0.4, 0.7));
    scene["lamp"] = {{"type", "point"}, {"position", {-1.2, 1.3, 1.0}}, {"intensity", {3, 3, 2.5}}};
    scene["sky"] = {{"type", "constant"}, {"radiance", {0.4, 0.5, 0.6}}};
    return scene;
}

/// Depth of field; glass and a mirror between the camera and what a spot and a lamp light; a cut-out sheet.
Json throughLens() {
    Json scene = specularBox();
    scene["sensor"]["type"] = "thinlens";
    scene["sensor"]["aperture_radius"] = 0.2;
    scene["sensor"]["focus_distance"] = 3.2;
    scene["spot"] = {{"type", "spot"}, {"intensity", {3, 3, 2}}, {"cutoff_angle", 50}};
    scene["spot"]["to_world"] = Json::array({{{"type", "lookat"}, {"origin", {0.6, 0.8, 0.8}}, {"target", {-0.3, -0.8, 0}}, {"up", {0, 0, 1}}}});
    scene["sheet"] = shape("rectangle", {scale(0.3, 0.3, 1), rotate('y', 25), translate(0.1, 0.1, 0.6)},
                           {{"type", "mask"}, {"opacity", {{"type", "checkerboard"}, {"color0", 0.3}, {"color1", 0.7}}},
                            {"inside", {{"type", "twosided"}, {"inside", diffuse(0.7, 0.6, 0.3)}}}});
    return scene;
}

/// Rough metal, rough glass and a coat, in the light of a picture all around and of the sun.
Json roughOutdoors() {
    Json scene = outdoors();
    scene.erase("lamp");
    scene["sky"]["radiance"] = {0.2, 0.25, 0.3};
    scene["sun"] = {{"type", "directional"}, {"direction", {0.5, -1, -0.7}}, {"irradiance", {2, 1.8, 1.5}}};
    scene["solid"]["bsdf"] = {{"type", "roughconductor"}, {"alpha_u", 0.15}, {"alpha_v", 0.4}, {"distribution", "ggx"}};
    scene["ball"]["bsdf"] = {{"type", "plastic"}, {"diffuse_reflectance", {0.6, 0.2, 0.1}}};
    scene["frosted"] = sphere(-1.0, -0.25, 0.5, 0.45, {{"type", "roughdielectric"}, {"alpha", 0.3}});
    scene["pane"] = shape("rectangle", {scale(0.6, 0.6, 1), rotate('y', 20), translate(0.5, 0.2, 1.5)}, {{"type", "thindielectric"}});
    scene["tube"] = {{"type", "cylinder"}, {"p0", {-0.4, -0.55, 1.1}}, {"p1", {0.4, -0.55, 1.0}}, {"radius", 0.15}, {"bsdf", {{"type", "roughplastic"}, {"alpha", 0.3}}}};
    return scene;
}

/// Textures in the light of a clear sky and the sun; a wide filter around a crop window, whose border cuts a lamp.
Json texturedOutdoors() {
    const auto checks = [](std::vector<double> a, std::vector<double> b, double times) {
        return Json{{"type", "checkerboard"}, {"color0", a}, {"color1", b}, {"to_uv", Json::array({scale(times, times, 1)})}};
    };
    Json scene = {{"type", "scene"}, {"sensor", camera(0, 1.4, 4, 40)}};
    scene["sensor"]["film"] = {{"type", "hdrfilm"},
                               {"width", kFilmSize + 16},
                               {"height", kFilmSize + 8},
                               {"crop_width", kFilmSize},
                               {"crop_height", kFilmSize},
                               {"crop_offset_x", 10},
                               {"crop_offset_y", 3},
                               {"rfilter", {{"type", "gaussian"}, {"stddev", 0.8}}}};
    const Json tiles = {{"type", "diffuse"}, {"reflectance", checks({0.7, 0.5, 0.3}, {0.1, 0.2, 0.3}, 4)}};
    // They fill the view: few of the paths that a walk from the light makes would show the sky itself.
    scene["ground"] = shape("rectangle", {scale(2.5, 2.5, 1), rotate('x', -90), translate(0, -0.7, 0)}, tiles);
    scene["wall"] = shape("rectangle", {scale(2.5, 1, 1), translate(0, 0.3, -2.5)}, tiles);
    scene["ball"] = sphere(-0.9, -0.2, 0.2, 0.5,
                           {{"type", "roughplastic"},
                            {"alpha", 0.3},
                            {"diffuse_reflectance", checks({0.6, 0.1, 0.1}, {0.2, 0.2, 0.7}, 1)}});
    scene["lamp"] = shape("rectangle", {scale(0.3, 0.3, 1), translate(1.05, 0.25, 0)}, diffuse(0, 0, 0));
    scene["lamp"]["emitter"] = {{"type", "area"}, {"radiance", {1.5, 1.2, 1}}};
    scene["sky"] = {{"type", "sunsky"},     {"sun_direction", {0.4, 0.7, 0.5}},
                    {"sky_scale", 4},       {"sun_aperture", 5},
                    {"to_world", Json::array({rotate('x', -90)})}};
    return scene;
}

std::unique_ptr<const AuditScene> make(const char* name, const char* holds, Json dictionary) {
    Scene scene = SceneDescription::fromNode(JsonNode(dictionary), ".").build();
    return std::unique_ptr<const AuditScene>(new AuditScene{name, holds, std::move(dictionary), std::move(scene), {6, 3}});
}

std::vector<std::unique_ptr<const AuditScene>> makeAll() {
    std::vector<std::unique_ptr<const AuditScene>> scenes;
    scenes.push_back(make("diffuse", "box with an area light and a block", diffuseBox()));
    scenes.push_back(make("specular", "the box with a glass sphere and a mirror", specularBox()));
    scenes.push_back(make("outdoor", "point light, environment, smooth normals", outdoors()));
    scenes.push_back(make("lens", "the specular box through a thin lens, with a spot and a cut-out sheet", throughLens()));
    scenes.push_back(make("rough", "rough metal and glass, coats, a pane, in the sun", roughOutdoors()));
    scenes.push_back(make("textured", "textures under a clear sky, a wide filter, a crop window, a lamp on its border", texturedOutdoors()));
    return scenes;
}

}  // namespace

const std::vector<std::unique_ptr<const AuditScene>>& auditScenes() {
    static const auto scenes = makeAll();
    return scenes;
}

}  // namespace ulam::audit
