#include "tests/support/path_scenes.h"

#include <unistd.h>

#include "core/base/error.h"
#include "core/image/image_io.h"

namespace ulam {
namespace {

const char* kSensor = R"({"type": "perspective", "fov": 55,
    "to_world": [{"type": "lookat", "origin": [0.1, 1.1, 3.4], "target": [0, 0.9, 0], "up": [0, 1, 0]}]})";

/// A wall: the rectangle [-1,1]² with normal +z, scaled by s, turned, and moved.
Json wall(double s, const Json& axis, double angle, const Json& to, double reflectance) {
    return {{"type", "rectangle"},
            {"to_world",
             {{{"type", "scale"}, {"value", s}},
              {{"type", "rotate"}, {"axis", axis}, {"angle", angle}},
              {{"type", "translate"}, {"value", to}}}},
            {"bsdf", {{"type", "diffuse"}, {"reflectance", {reflectance, 0.7 * reflectance, 0.9 * reflectance}}}}};
}

Json ball(const Json& center, double radius, const Json& bsdf) {
    return {{"type", "sphere"}, {"center", center}, {"radius", radius}, {"bsdf", bsdf}};
}

Json diffuse(double reflectance) {
    return {{"type", "diffuse"}, {"reflectance", reflectance}};
}

Json lamp() {
    Json light = wall(0.4, {1, 0, 0}, 90, {0.2, 1.95, 0.3}, 0.2);
    light["emitter"] = {{"type", "area"}, {"radiance", {9, 8, 5}}};
    return light;
}

Json floorAndBack() {
    return {{"type", "scene"},
            {"sensor", Json::parse(kSensor)},
            {"floor", wall(1.5, {1, 0, 0}, -90, {0, 0, 0.5}, 0.7)},
            {"back", wall(1.5, {1, 0, 0}, 0, {0, 1, -1}, 0.8)}};
}

Json room() {
    Json scene = floorAndBack();
    scene["left"] = wall(1.5, {0, 1, 0}, 90, {-1, 1, 0.5}, 0.6);
    scene["right"] = wall(1.5, {0, 1, 0}, -90, {1, 1, 0.5}, 0.5);
    scene["ceiling"] = wall(1.5, {1, 0, 0}, 90, {0, 2, 0.5}, 0.7);
    return scene;
}

Json diffuseRoom() {
    Json scene = room();
    scene["lamp"] = lamp();
    scene["ball"] = ball({-0.4, 0.35, -0.2}, 0.35, diffuse(0.6));
    return scene;
}

Json glassAndMirror() {
    Json scene = room();
    scene["lamp"] = lamp();
    scene["glass"] = ball({0.4, 0.4, 0.5}, 0.35, {{"type", "dielectric"}, {"specular_transmittance", {0.9, 1, 0.8}}});
    scene["mirror"] =
        ball({-0.45, 0.45, -0.3}, 0.4, {{"type", "conductor"}, {"eta", {0.2, 0.9, 1.1}}, {"k", {3.9, 2.4, 2.2}}});
    scene["sheet"] = wall(0.35, {0, 1, 0}, 220, {0, 1.3, 0}, 0.5);
    scene["sheet"]["bsdf"] = {{"type", "twosided"}, {"front", {{"type", "conductor"}}}, {"back", diffuse(0.6)}};
    return scene;
}

Json pointLight() {
    Json scene = room();
    scene["light"] = {{"type", "point"}, {"position", {0.3, 1.6, 0.2}}, {"intensity", {3, 4, 5}}};
    scene["glass"] = ball({0.3, 0.5, 0.2}, 0.3, {{"type", "dielectric"}});
    return scene;
}

Json environment() {
    Json scene = floorAndBack();
    scene["sky"] = {{"type", "constant"}, {"radiance", {0.6, 0.8, 1}}};
    scene["glass"] = ball({0.4, 0.5, 0.3}, 0.4, {{"type", "dielectric"}, {"int_ior", 1.33}});
    scene["ball"] = ball({-0.5, 0.4, 0}, 0.4, diffuse(0.7));
    return scene;
}

/// An octahedron.
Json octahedron(const Imath::V3d& c, double r) {
    Json positions = Json::array(), normals = Json::array();
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
            for (int i = 0; i < 3; ++i) {
                normals.push_back(i == axis ? side : 0.0);
                positions.push_back(c[i] + (i == axis ? side * r : 0.0));
            }
    Json triangles = Json::array();
    for (const auto& t :
         {std::array{1, 3, 5}, {3, 0, 5}, {0, 2, 5}, {2, 1, 5}, {3, 1, 4}, {0, 3, 4}, {2, 0, 4}, {1, 2, 4}})
        for (const int i : t) triangles.push_back(i);
    return {{"type", "mesh"},
            {"positions", positions},
            {"triangles", triangles},
            {"normals", normals},
            {"bsdf", diffuse(0.5)}};
}

Json manyLights() {
    Json scene = floorAndBack();
    scene["lamp"] = lamp();
    scene["glow"] = ball({-0.7, 0.3, 0.4}, 0.2, diffuse(0.4));
    scene["glow"]["emitter"] = {{"type", "area"}, {"radiance", {2, 1, 1}}};
    scene["crystal"] = octahedron({0.6, 0.4, 0.2}, 0.3);
    scene["crystal"].erase("normals");
    scene["crystal"]["emitter"] = {{"type", "area"}, {"radiance", {1, 2, 1}}};
    scene["bulb"] = {{"type", "point"}, {"position", {0, 1, 0.6}}, {"intensity", 0.7}};
    scene["sky"] = {{"type", "constant"}, {"radiance", 0.3}};
    scene["mirror"] = ball({0, 0.4, -0.4}, 0.35, {{"type", "conductor"}});
    return scene;
}

Json shadingNormals() {
    Json scene = room();
    scene["lamp"] = lamp();
    scene["smooth"] = octahedron({-0.2, 0.6, 0.1}, 0.55);
    scene["lens"] = octahedron({0.6, 0.4, 0.6}, 0.35);
    scene["lens"]["bsdf"] = {{"type", "dielectric"}};
    return scene;
}

/// Microfacets of both distributions, coats, a pane and a ball that is not there.
Json roughThings() {
    Json scene = room();
    scene["lamp"] = lamp();
    scene["metal"] = ball({-0.55, 0.35, -0.3}, 0.35, {{"type", "roughconductor"}, {"distribution", "ggx"}, {"alpha_u", 0.1}, {"alpha_v", 0.4}, {"eta", {0.2, 0.9, 1.1}}, {"k", {3.9, 2.4, 2.2}}});
    scene["frosted"] = ball({0.5, 0.35, 0.5}, 0.35, {{"type", "roughdielectric"}, {"alpha", 0.3}});
    scene["coat"] = ball({0.5, 0.4, -0.4}, 0.35, {{"type", "plastic"}, {"diffuse_reflectance", {0.6, 0.3, 0.2}}, {"nonlinear", true}});
    scene["rough coat"] = ball({-0.5, 1.1, -0.4}, 0.3, {{"type", "roughplastic"}, {"alpha", 0.2}});
    scene["pane"] = wall(0.4, {0, 1, 0}, 25, {-0.3, 0.8, 0.9}, 0.5);
    scene["pane"]["bsdf"] = {{"type", "thindielectric"}, {"specular_transmittance", {0.9, 1, 0.8}}};
    scene["nothing"] = ball({0.3, 1.2, 0.7}, 0.3, {{"type", "null"}});
    return scene;
}

/// A camera with a wide aperture looks through a cut-out sheet at what a spot and a lamp light.
Json thinLens() {
    Json scene = room();
    scene["sensor"]["type"] = "thinlens";
    scene["sensor"]["aperture_radius"] = 0.15;
    scene["sensor"]["focus_distance"] = 3.0;
    scene["lamp"] = lamp();
    scene["spot"] = {{"type", "spot"}, {"intensity", {20, 15, 10}}, {"cutoff_angle", 35}};
    scene["spot"]["to_world"] = {{{"type", "lookat"}, {"origin", {-0.6, 1.7, 0.8}}, {"target", {0.1, 0.2, -0.2}}, {"up", {0, 0, 1}}}};
    scene["sheet"] = wall(0.5, {0, 1, 0}, 30, {0.2, 0.8, 0.9}, 0.5);
    scene["sheet"]["bsdf"] = {{"type", "mask"},
                              {"opacity", {{"type", "checkerboard"}, {"color0", 0.2}, {"color1", 0.8}, {"to_uv", {{{"type", "scale"}, {"value", 3}}}}}},
                              {"inside", {{"type", "twosided"}, {"inside", diffuse(0.7)}}}};
    scene["mirror"] = ball({-0.45, 0.45, -0.3}, 0.4, {{"type", "conductor"}, {"eta", {0.2, 0.9, 1.1}}, {"k", {3.9, 2.4, 2.2}}});
    return scene;
}

/// A picture of the sky, the sun, a textured floor; a disc and an open cylinder, which shines.
Json sunAndSky() {
    Json scene = floorAndBack();
    scene["floor"]["bsdf"]["reflectance"] = {{"type", "bitmap"}, {"filename", "sky.exr"}, {"to_uv", {{{"type", "scale"}, {"value", {2, 3, 1}}}}}};
    scene["sky"] = {{"type", "envmap"}, {"filename", "sky.exr"}, {"scale", 2}, {"to_world", {{{"type", "rotate"}, {"axis", {0.2, 1, 0}}, {"angle", 40}}}}};
    scene["sun"] = {{"type", "directional"}, {"direction", {0.4, -1, -0.6}}, {"irradiance", {2, 1.8, 1.5}}};
    scene["glass"] = ball({0.4, 0.5, 0.3}, 0.4, {{"type", "dielectric"}, {"int_ior", 1.33}});
    scene["disc"] = {{"type", "disk"},
                     {"to_world", {{{"type", "scale"}, {"value", {0.5, 0.3, 1}}}, {{"type", "rotate"}, {"axis", {1, 0.5, 0}}, {"angle", -50}}, {{"type", "translate"}, {"value", {-0.7, 1, 0}}}}},
                     {"bsdf", {{"type", "twosided"}, {"inside", diffuse(0.8)}}}};
    scene["tube"] = {{"type", "cylinder"}, {"p0", {-0.6, 0.1, 0.5}}, {"p1", {-0.2, 0.4, 0.3}}, {"radius", 0.15}, {"bsdf", diffuse(0.4)}};
    scene["tube"]["emitter"] = {{"type", "area"}, {"radiance", {{"type", "checkerboard"}, {"color0", {3, 2, 1}}, {"color1", 0.5}, {"to_uv", {{{"type", "scale"}, {"value", {4, 2, 1}}}}}}}};
    return scene;
}

/// Mixtures and masks, also of each other and of what is specular; surfaces with bumps and with normals of a picture.
Json layers() {
    Json scene = room();
    scene["lamp"] = lamp();
    const Json heights = {{"type", "bitmap"}, {"filename", "sky.exr"}};
    const Json normals = {{"type", "bitmap"}, {"filename", "normals.exr"}, {"raw", true}};
    const Json glass = {{"type", "dielectric"}}, metal = {{"type", "roughconductor"}, {"alpha", 0.2}};
    scene["floor"]["bsdf"] = {{"type", "twosided"}, {"inside", {{"type", "bumpmap"}, {"scale", 0.1}, {"heights", heights}, {"inside", diffuse(0.6)}}}};
    scene["veil"] = ball({-0.55, 0.35, -0.3}, 0.35, {{"type", "blendbsdf"}, {"weight", 0.4}, {"a", glass}, {"b", {{"type", "plastic"}}}});
    scene["holes"] = ball({0.5, 0.35, 0.5}, 0.35, {{"type", "mask"}, {"opacity", {{"type", "checkerboard"}, {"color0", 0.3}, {"color1", 0.9}}}, {"inside", {{"type", "thindielectric"}}}});
    scene["three"] = ball({0.5, 0.4, -0.4}, 0.35, {{"type", "mixturebsdf"}, {"weights", {0.3, 0.4, 0.2}}, {"a", metal}, {"b", {{"type", "conductor"}}}, {"c", diffuse(0.5)}});
    scene["waves"] = ball({-0.5, 1.1, -0.4}, 0.3, {{"type", "bumpmap"}, {"scale", 0.2}, {"heights", heights}, {"inside", glass}});
    scene["lacquer"] = ball({-0.1, 0.3, 0.8}, 0.25, {{"type", "coating"}, {"thickness", 0.5}, {"sigma_a", {0.1, 0.4, 0.8}}, {"inside", {{"type", "blendbsdf"}, {"a", {{"type", "conductor"}}}, {"b", diffuse(0.8)}}}});
    scene["satin"] = ball({-0.1, 1.5, -0.5}, 0.25, {{"type", "roughcoating"}, {"alpha", 0.2}, {"inside", {{"type", "blendbsdf"}, {"a", metal}, {"b", {{"type", "conductor"}}}}}});
    scene["dents"] = ball({0.3, 1.2, 0.7}, 0.3, {{"type", "blendbsdf"}, {"weight", heights}, {"a", {{"type", "normalmap"}, {"normalmap", normals}, {"inside", {{"type", "roughplastic"}}}}},
                                                 {"b", {{"type", "mask"}, {"opacity", 0.7}, {"inside", metal}}}});
    return scene;
}

/// Two groups, placed by turned, stretched, mirrored and sheared instances: one of meshes (smooth and textured), one of what
/// has to stay round.
Json instances() {
    Json scene = room();
    scene["lamp"] = lamp();
    Json tile = wall(0.25, {1, 0, 0}, -90, {0, -0.2, 0}, 0.6);
    tile["bsdf"]["reflectance"] = {{"type", "checkerboard"}, {"color0", 0.2}, {"color1", {0.8, 0.7, 0.3}}, {"to_uv", {{{"type", "scale"}, {"value", {4, 3, 1}}}}}};
    Json brushed = wall(0.2, {0, 1, 0}, 20, {0.1, 0.25, 0.1}, 0.6);
    brushed["bsdf"] = {{"type", "twosided"}, {"inside", {{"type", "roughconductor"}, {"distribution", "ggx"}, {"alpha_u", 0.1}, {"alpha_v", 0.4}, {"eta", {0.2, 0.9, 1.1}}, {"k", {3.9, 2.4, 2.2}}}}};
    Json gem = octahedron({0, 0, 0}, 0.2);
    gem["bsdf"] = {{"type", "dielectric"}};
    scene["flower"] = {{"type", "shapegroup"}, {"tile", tile}, {"gem", gem}, {"brushed", brushed}};
    scene["round"] = {{"type", "shapegroup"}, {"ball", ball({0, 0.1, 0}, 0.1, {{"type", "conductor"}})}, {"bud", octahedron({0, 0.35, 0}, 0.12)},
                      {"stem", {{"type", "cylinder"}, {"p0", {0, -0.3, 0}}, {"p1", {0, 0, 0}}, {"radius", 0.04}, {"bsdf", {{"type", "twosided"}, {"inside", diffuse(0.5)}}}}}};
    const auto place = [&](const char* group, const Json& steps) {
        return Json{{"type", "instance"}, {"group", {{"type", "ref"}, {"id", group}}}, {"to_world", steps}};
    };
    const auto move = [](const Json& to) { return Json{{"type", "translate"}, {"value", to}}; };
    scene["one"] = place("flower", {move({-0.55, 0.4, 0})});
    scene["two"] = place("flower", {{{"type", "scale"}, {"value", {-1.2, 0.8, 1.5}}}, {{"type", "rotate"}, {"axis", {1, 2, 0.5}}, {"angle", 70}}, move({0.4, 0.5, 0.3})});
    scene["three"] = place("flower", {{{"type", "matrix"}, {"value", {1, 0.4, 0, 0, 0, 1, 0.3, 1.2, 0.2, 0, 0.7, 0.2, 0, 0, 0, 1}}}});
    scene["four"] = place("round", {{{"type", "scale"}, {"value", {1.3, 1.3, -1.3}}}, {{"type", "rotate"}, {"axis", {0, 0, 1}}, {"angle", -30}}, move({0.5, 1.2, -0.3})});
    scene["five"] = place("round", {move({-0.2, 0.3, 0.8})});
    return scene;
}

/// A sky above its horizon and a sun, wide enough for walks to find it.
Json clearSky() {
    Json scene = floorAndBack();
    scene["sky"] = {{"type", "sunsky"}, {"sun_direction", {0.5, 0.6, 0.4}}, {"sun_aperture", 20}, {"to_world", {{{"type", "rotate"}, {"axis", {1, 0, 0}}, {"angle", -90}}}}};
    scene["ball"] = ball({-0.5, 0.4, 0}, 0.4, diffuse(0.7));
    scene["metal"] = ball({0.4, 0.4, 0.3}, 0.4, {{"type", "roughconductor"}, {"alpha", 0.3}});
    return scene;
}

/// Holds sky.exr, a small picture, and normals.exr, which holds normals.
const std::filesystem::path& sceneFolder() {
    static const struct Folder {
        std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("ulam_path_scenes_{}", getpid());
        Folder() {
            std::filesystem::create_directories(path);
            Image sky(8, 5);
            Random random(makeKey(77), 0, 0);
            for (Rgb& pixel : sky.pixels)
                for (int c = 0; c < 3; ++c) pixel[c] = float(0.9 * random() * random());
            writeExr((path / "sky.exr").string(), sky);
            Image normals(6, 4);
            for (Rgb& pixel : normals.pixels) pixel = Rgb(float(0.3 + 0.4 * random()), float(0.3 + 0.4 * random()), float(0.8 + 0.2 * random()));
            writeExr((path / "normals.exr").string(), normals);
        }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    } folder;
    return folder.path;
}

}  // namespace

SceneDescription describeScene(const Json& dictionary) {
    return SceneDescription::fromNode(JsonNode(dictionary), sceneFolder());
}

Scene buildScene(const Json& dictionary, const Json& film) {
    return describeScene(dictionary).build(film);
}

const std::vector<PathScene>& pathScenes() {
    static const std::vector<PathScene> scenes = {
        {"diffuse", diffuseRoom(), false, false},   {"glass_and_mirror", glassAndMirror(), true, false},
        {"point_light", pointLight(), true, false}, {"environment", environment(), true, true},
        {"many_lights", manyLights(), true, true},  {"shading_normals", shadingNormals(), true, false},
        {"rough", roughThings(), true, false},      {"thin_lens", thinLens(), true, false},     {"sun_and_sky", sunAndSky(), true, true},
        {"layers", layers(), true, false},
        {"instances", instances(), true, false},
        {"clear_sky", clearSky(), false, true},
    };
    return scenes;
}

const PathScene& pathScene(const std::string& name) {
    for (const PathScene& scene : pathScenes())
        if (scene.name == name) return scene;
    fail(ExitCode::Usage, "no test scene {}", name);
}

}  // namespace ulam
