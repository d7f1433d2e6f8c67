// pbrt-v4's materials, textures, shapes and lights.

#include <chrono>

#include "core/image/image_io.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/octahedral_map.h"
#include "core/scene/pbrt/subdivision.h"
#include "core/scene/bsdfs/metals.h"
#include "tests/core/scene/pbrt_scene.h"

using namespace ulam;

namespace {

Json bsdf(const PbrtScene& pbrt, const std::string& material) {
    const Json all = pbrt.read("Material " + material + " Shape \"sphere\"").json()["material"];
    return all["type"] == "twosided" ? all["bsdf"] : all;
}

std::string substitutions(const JsonDocument& document) {
    return document.json().contains("$substitutions") ? document.json()["$substitutions"].dump() : "";
}

Vec3f faceNormal(const Scene& scene, size_t shape) {
    return std::get<Mesh>(scene.shapes.at(shape).geometry).faceNormals.at(0);
}

}  // namespace

TEST_CASE("pbrt: materials become BSDFs") {
    const PbrtScene pbrt;
    CHECK(bsdf(pbrt, "\"diffuse\"") == Json::parse(R"({"type": "diffuse", "reflectance": 0.5})"));
    CHECK(bsdf(pbrt, "\"interface\"") == Json::parse(R"({"type": "null"})"));
    CHECK(bsdf(pbrt, "\"conductor\"") == Json::parse(R"({"type": "conductor", "material": "Cu"})"));
    CHECK(bsdf(pbrt, R"("conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float roughness" 0.25)") ==
          Json::parse(R"({"type": "roughconductor", "distribution": "ggx", "alpha": 0.5, "material": "Au"})"));
    CHECK(
        bsdf(
            pbrt,
            R"("conductor" "rgb eta" [ 1 2 3 ] "rgb k" [ 4 5 6 ] "bool remaproughness" false "float uroughness" .1 "float vroughness" .2)") ==
        Json::parse(
            R"({"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.1, "alpha_v": 0.2, "eta": [1.0, 2.0, 3.0], "k": [4.0, 5.0, 6.0]})"));
    // 36 % at normal incidence: k² / (4 + k²).
    near(bsdf(pbrt, R"("conductor" "rgb reflectance" [ .36 .5 0 ])")["k"], {1.5, 2, 0});
    CHECK(bsdf(pbrt, "\"dielectric\"") == Json::parse(R"({"type": "dielectric", "int_ior": 1.5, "ext_ior": 1})"));
    CHECK(bsdf(pbrt, R"("dielectric" "spectrum eta" "glass-BK7")")["int_ior"] == 1.5168);
    CHECK(bsdf(pbrt, R"("dielectric" "float eta" 1.3 "float roughness" 0.01)") ==
          Json::parse(
              R"({"type": "roughdielectric", "int_ior": 1.3, "ext_ior": 1, "distribution": "ggx", "alpha": 0.1})"));
    CHECK(bsdf(pbrt, "\"thindielectric\"") ==
          Json::parse(R"({"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1})"));
    const auto coated =
        pbrt.read(R"(Material "coateddiffuse" "rgb reflectance" [ .1 .2 .3 ] "float roughness" 0.04 Shape "sphere")");
    CHECK(entry(coated, "material")["bsdf"] ==
          Json::parse(R"({"type": "roughplastic", "diffuse_reflectance": [0.1, 0.2, 0.3], "int_ior": 1.5,
        "ext_ior": 1, "nonlinear": true, "alpha": 0.2, "distribution": "ggx"})"));
    CHECK(mentions(substitutions(coated), "is written as the nearest"));
    CHECK(bsdf(pbrt, "\"coateddiffuse\"")["type"] == "plastic");
    const auto metal = pbrt.read(
        R"(Material "coatedconductor" "float interface.roughness" 0 "float conductor.roughness" 0.01 Shape "sphere")");
    const Json coat = entry(metal, "material")["bsdf"];
    CHECK(coat["type"] == "coating");
    CHECK(coat["int_ior"] == 1.5);
    CHECK(coat["bsdf"]["alpha"] == 0.1);
    CHECK(coat["bsdf"]["eta"][1].get<double>() == Approx(findMetal("Cu")->eta.y / 1.5));
    CHECK(coat["bsdf"]["k"][2].get<double>() == Approx(findMetal("Cu")->k.z / 1.5));
    CHECK(mentions(substitutions(metal), "is written as the nearest"));
    CHECK(entry(pbrt.read(R"(Material "coatedconductor" "float interface.roughness" 0.04 Shape "sphere")"), "material")["bsdf"]["alpha"] == 0.2);
    // Materials that are only named are checked too, and may be named before they are made.
    CHECK(pbrt.complaint(R"(MakeNamedMaterial "m" "string type" "diffuse" "float roughnes" 1)").has("roughnes"));
    CHECK(entry(pbrt.read(R"(NamedMaterial "m" Shape "sphere" MakeNamedMaterial "m" "string type" "dielectric")"),
                "shape")["bsdf"]["id"] == "m");
    CHECK(
        pbrt.complaint(R"(Material "dielectric" "rgb eta" [ 1 1 1 ] Shape "sphere")").has("of type float or spectrum"));
    CHECK(pbrt.complaint(R"(Material "dielectric" "spectrum eta" "glass-BK8" Shape "sphere")")
              .has("did you mean \"glass-BK7\""));
    CHECK(
        pbrt.complaint(R"(Material "conductor" "spectrum eta" "metal-Xx-eta" "spectrum k" "metal-Xx-k" Shape "sphere")")
            .has("unknown metal"));
}

TEST_CASE("pbrt: a mixture is a blend where there is one, else refused") {
    const PbrtScene pbrt;
    const std::string world =
        R"(MakeNamedMaterial "a" "string type" "diffuse" MakeNamedMaterial "b" "string type" "conductor"
        MakeNamedMaterial "c" "string type" "mix" "string materials" [ "a" "b" ] "float amount" .25 NamedMaterial "c" Shape "sphere")";
    if (contains(scenePlugins(PluginKind::Bsdfs), "blendbsdf")) {
        CHECK(
            entry(pbrt.read(world), "c") ==
            Json::parse(
                R"({"type": "blendbsdf", "weight": 0.25, "bsdf_0": {"type": "ref", "id": "a"}, "bsdf_1": {"type": "ref", "id": "b"}})"));
        CHECK(pbrt.complaint(R"(MakeNamedMaterial "c" "string type" "mix" "string materials" [ "c" "c" ])")
                  .has("hold themselves"));
    } else {
        CHECK(pbrt.complaint(world).has("material \"c\" is not supported"));
    }
    CHECK(pbrt.complaint(R"(Material "mix" "string materials" [ "a" ] Shape "sphere")")
              .has("mixes two materials, found 1"));
}

TEST_CASE("pbrt: textures, their mappings, and arithmetic that leaves one of them") {
    const PbrtScene pbrt;
    Image image(2, 2);
    image.at(0, 0) = {0.1f, 0.1f, 0.1f}, image.at(1, 0) = {0.2f, 0.2f, 0.2f}, image.at(0, 1) = {0.3f, 0.3f, 0.3f},
                image.at(1, 1) = {0.4f, 0.4f, 0.4f};
    writeExr((pbrt.folder.path / "a.exr").string(), image);
    const std::string quad =
        R"(Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point3 P" [ 0 0 0 1 0 0 1 1 0 0 1 0 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ])";
    const auto at = [&](const std::string& textures, const std::string& shape, const Vec2f& uv) {
        const Scene scene = pbrt.loadWorld("LightSource \"point\"\n" + textures +
                                           "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n" + shape);
        REQUIRE(scene.textures.size() == 1);
        return dispatch(scene.textures[0], [&](const auto& t) { return t.color(uv); });
    };
    const std::string picture =
        R"(Texture "t" "spectrum" "imagemap" "string filename" "a.exr" "string filter" "point" )";
    // pbrt's v grows upwards in the picture.
    CHECK(at(picture, quad, {0.25f, 0.25f}).x == Approx(0.3));
    CHECK(at(picture, quad, {0.75f, 0.75f}).x == Approx(0.2));
    CHECK(at(picture + R"("float scale" 2 "float udelta" .5)", quad, {0.25f, 0.25f}).x == Approx(0.8));
    CHECK(at(picture + R"("bool invert" true "float vscale" 3)", quad, {0.25f, 0.25f}).x == Approx(0.9));
    // On a sphere v grows from the south pole there and from the north pole here; on a disk it falls with the radius.
    CHECK(at(picture, "Shape \"sphere\"", {0.25f, 0.25f}).x == Approx(0.1));
    CHECK(at(picture, "Shape \"disk\"", {0.75f, 0.25f}).x == Approx(0.3));
    CHECK(at(picture, "Shape \"disk\"", {0.25f, 0.75f}).x == Approx(0.2));
    // Without texture coordinates the corners of each triangle have (0,0), (1,0), (1,1).
    const Scene bare = pbrt.loadWorld("LightSource \"point\"\n" + picture +
                                      "Material \"diffuse\" \"texture reflectance\" \"t\" "
                                      R"(Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ])");
    CHECK(std::get<Mesh>(bare.shapes[0].geometry).texcoords == std::vector<Vec2f>{{0, 0}, {1, 0}, {1, 1}});

    // Squares are units of s and t; the first colour has the origin.
    const std::string checks =
        R"(Texture "t" "spectrum" "checkerboard" "float uscale" 4 "rgb tex1" [ .5 .5 .5 ] "rgb tex2" [ .25 .25 .25 ] )";
    CHECK(at(checks, quad, {0.1f, 0.1f}).x == Approx(0.5));
    CHECK(at(checks, quad, {0.3f, 0.1f}).x == Approx(0.25));
    CHECK(at(checks, quad, {0.6f, 0.9f}).x == Approx(0.5));
    CHECK(
        at(R"(Texture "c" "spectrum" "checkerboard" "rgb tex1" [ .5 .5 .5 ] Texture "t" "spectrum" "scale" "texture tex" "c" "float scale" .5)",
           quad, {0.5f, 0.5f})
            .x == Approx(0.25));
    CHECK(
        at(R"(Texture "c" "float" "checkerboard" Texture "t" "spectrum" "mix" "rgb tex1" [ .1 .1 .1 ] "rgb tex2" [ .7 .7 .7 ] "texture amount" "c")",
           quad, {0.5f, 0.5f})
            .x == Approx(0.7));
    const auto constant = [&](const std::string& textures) {
        return entry(pbrt.read(textures + R"( Material "diffuse" "texture reflectance" "t" Shape "sphere")"),
                     "material")["bsdf"]["reflectance"];
    };
    CHECK(constant(R"(Texture "t" "spectrum" "constant" "rgb value" [ .1 .2 .3 ])") == Json({0.1, 0.2, 0.3}));
    CHECK(
        constant(
            R"(Texture "h" "spectrum" "constant" "rgb value" [ .5 .5 .5 ] Texture "t" "spectrum" "scale" "texture tex" "h" "float scale" .5)") ==
        0.25);
    CHECK(constant(R"(Texture "t" "spectrum" "mix" "float amount" .25)") == 0.25);

    // One entry however often it is used, and one more for a shape with other parameters.
    const auto shared = pbrt.read(picture + R"(Material "diffuse" "texture reflectance" "t" )" + quad + quad +
                                  R"(Material "diffuse" "texture reflectance" "t" Shape "sphere")" + quad)
                            .json();
    CHECK(shared.contains("t"));
    CHECK(shared.contains("t_2"));
    CHECK(!shared.contains("t_3"));
    const Json masked = pbrt.read(R"(Texture "a" "float" "imagemap" "string filename" "a.exr" Material "dielectric" )" +
                                  quad + R"( "texture alpha" "a")" + quad + R"( "float alpha" .5)")
                            .json();
    CHECK(masked["shape"]["bsdf"]["id"] == "mask");
    CHECK(masked["mask"]["opacity"] == Json::parse(R"({"type": "ref", "id": "a"})"));
    CHECK(masked["mask"]["bsdf"]["id"] == "material");
    CHECK(masked["mask_2"]["opacity"] == 0.5);

    CHECK(pbrt.complaint(picture + R"(Texture "u" "spectrum" "scale" "texture tex" "t" "texture scale" "v")")
              .has("unknown texture \"v\""));
    CHECK(pbrt.complaint(R"(Texture "t" "spectrum" "imagemap" "string filename" "a.exr" "string wrap" "black")")
              .has("wrap \"black\""));
    CHECK(pbrt.complaint(R"(Texture "t" "spectrum" "imagemap")").has("has no \"filename\""));
    CHECK(pbrt.complaint(R"(Texture "t" "float" "constant" Texture "t" "float" "constant")")
              .has("another float texture"));
    CHECK(
        pbrt.complaint(
                R"(Texture "r" "float" "imagemap" "string filename" "a.exr" Material "conductor" "texture roughness" "r" Shape "sphere")")
            .has("remaproughness"));
    CHECK(entry(pbrt.read(R"(Texture "r" "float" "imagemap" "string filename" "a.exr" "string encoding" "linear"
        Material "conductor" "texture roughness" "r" "bool remaproughness" false Shape "sphere")"),
                "material")["bsdf"]["alpha"]["id"] == "r");
    pbrt.folder.write("bare.ply", kTrianglePly);
    CHECK(pbrt.complaint(picture +
                         R"(Material "diffuse" "texture reflectance" "t" Shape "plymesh" "string filename" "bare.ply")")
              .has("without texture coordinates"));
}

TEST_CASE("pbrt: sides of shapes") {
    const PbrtScene pbrt;
    pbrt.folder.write("t.ply", kTrianglePly);
    const std::string flat = R"(Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] )",
                      smooth = flat + R"("normal N" [ 0 0 -1 0 0 -1 0 0 -1 ] )";
    const std::string file = R"(Shape "plymesh" "string filename" "t.ply" )", lamp = "LightSource \"point\"\n";
    for (const std::string& mesh : {flat, file}) {
        INFO(mesh);
        CHECK(faceNormal(pbrt.loadWorld(lamp + mesh), 0).z == 1);
        CHECK(faceNormal(pbrt.loadWorld(lamp + "ReverseOrientation " + mesh), 0).z == -1);
        // The normal moves with the surface, though a mirroring turns the winding.
        CHECK(faceNormal(pbrt.loadWorld(lamp + "Scale -1 1 1 " + mesh), 0).z == 1);
        CHECK(faceNormal(pbrt.loadWorld(lamp + "Scale 1 1 -1 " + mesh), 0).z == -1);
        CHECK(faceNormal(pbrt.loadWorld(lamp + "Scale -1 1 1 ReverseOrientation " + mesh), 0).z == -1);
    }
    CHECK(faceNormal(pbrt.loadWorld(lamp + smooth), 0).z == -1);
    CHECK(faceNormal(pbrt.loadWorld(lamp + "Scale -1 1 1 ReverseOrientation " + smooth), 0).z == 1);
    const auto outward = [&](const std::string& state) {
        return !pbrt.loadWorld(lamp + state + " Shape \"sphere\"").shapes[0].flipNormals;
    };
    CHECK(outward(""));
    CHECK(outward("Scale -1 1 1"));
    CHECK(!outward("ReverseOrientation"));
    CHECK(!outward("Scale -1 1 1 ReverseOrientation"));
    const auto disk = [&](const std::string& state) {
        return std::get<Disk>(pbrt.loadWorld(lamp + state).shapes[0].geometry);
    };
    CHECK(disk(R"(Shape "disk" "float radius" 2 "float height" 3)").normal.z == 1);
    CHECK(disk(R"(Shape "disk" "float radius" 2 "float height" 3)").center == Vec3f(0, 0, 3));
    CHECK(length(disk(R"(Shape "disk" "float radius" 2 "float height" 3)").axisX) == 2);
    CHECK(disk("ReverseOrientation Shape \"disk\"").normal.z == -1);
    const auto cylinder = std::get<Cylinder>(
        pbrt.loadWorld(lamp + R"(Shape "cylinder" "float radius" 2 "float zmin" 1 "float zmax" 4)").shapes[0].geometry);
    CHECK(cylinder.length == 3);
    CHECK(cylinder.base == Vec3f(0, 0, 1));
    CHECK(pbrt.complaint(R"(Shape "sphere" "float phimax" 180)")
              .has("\"phimax\" of shape \"sphere\" is 180: parts of shapes"));
    CHECK(pbrt.complaint(R"(Shape "sphere" "float radius" 2 "float zmin" -1)").has("\"zmin\""));
    CHECK(pbrt.complaint(R"(Shape "disk" "float innerradius" .5)").has("parts of shapes"));
    CHECK(pbrt.complaint(R"(Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 3 ])")
              .has("names vertex 3, but there are 3"));
    CHECK(pbrt.complaint(R"(Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "point2 uv" [ 0 0 ])")
              .has("has 1 values for 3 vertices"));
    CHECK(pbrt.complaint(R"(Shape "plymesh" "string filename" "no.ply")").has("there is no file \"no.ply\""));
}

TEST_CASE("pbrt: instances are copies, moved twice") {
    const PbrtScene pbrt;
    const std::string world = R"(LightSource "point" ObjectBegin "o" Material "conductor" Translate 1 0 0 Shape "sphere"
        Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] ObjectEnd Shape "sphere"
        AttributeBegin Scale 2 2 2 ObjectInstance "o" AttributeEnd Translate 0 5 0 ObjectInstance "o")";
    if (contains(scenePlugins(PluginKind::Shapes), "instance")) {
        CHECK(entry(pbrt.read(world), "instance")["shapegroup"] == Json::parse(R"({"type": "ref", "id": "o"})"));
        return;
    }
    const Scene scene = pbrt.loadWorld(world);
    REQUIRE(scene.shapes.size() == 5);
    CHECK(std::get<Sphere>(scene.shapes[0].geometry).center == Vec3f(0, 0, 0));
    CHECK(std::get<Sphere>(scene.shapes[1].geometry).center == Vec3f(2, 0, 0));
    CHECK(std::get<Sphere>(scene.shapes[1].geometry).radius == 2);
    CHECK(std::get<Mesh>(scene.shapes[2].geometry).positions[1] == Vec3f(4, 0, 0));
    CHECK(std::get<Sphere>(scene.shapes[3].geometry).center == Vec3f(1, 5, 0));
    CHECK(entry(pbrt.read(world), "shape")["bsdf"]["type"] == "twosided");  // ObjectEnd ends what the object set
}

TEST_CASE("pbrt: lights") {
    const PbrtScene pbrt;
    const auto light = [&](const std::string& text) { return entry(pbrt.read("LightSource " + text), "light"); };
    CHECK(light("\"point\"") == Json::parse(R"({"type": "point", "position": [0.0, 0.0, 0.0], "intensity": 1.0})"));
    CHECK(light(R"("point" "rgb I" [ 1 2 3 ] "float scale" 2)")["intensity"] == Json({2.0, 4.0, 6.0}));
    CHECK(light(R"("point" "float power" 50)")["intensity"].get<double>() == Approx(50 / (4 * kPi)));
    const Json spot =
        light(R"("spot" "point3 from" [ 1 2 3 ] "point3 to" [ 4 5 6 ] "float coneangle" 40 "float conedeltaangle" 10)");
    CHECK(spot["cutoff_angle"] == 40.0);
    CHECK(spot["beam_width"] == 30.0);
    CHECK(spot["to_world"] ==
          Json::parse(R"([{"type": "lookat", "origin": [1.0, 2.0, 3.0], "target": [4.0, 5.0, 6.0]}])"));
    CHECK(mentions(substitutions(pbrt.read("LightSource \"spot\"")), "fades linearly"));
    CHECK(substitutions(pbrt.read("LightSource \"spot\" \"float conedeltaangle\" 0")).empty());
    // ∫ over the cone of pbrt's own falloff, which is smoothstep in the cosine.
    CHECK(light(R"("spot" "float coneangle" 90 "float conedeltaangle" 0 "float power" 6)")["intensity"].get<double>() ==
          Approx(6 / (2 * kPi)));
    const Json sun = light(R"("distant" "point3 from" [ 0 5 0 ] "point3 to" [ 0 1 0 ] "float illuminance" 3)");
    CHECK(sun == Json::parse(R"({"type": "directional", "direction": [0.0, -4.0, 0.0], "irradiance": 3.0})"));
    CHECK(light(R"("infinite" "rgb L" [ 1 2 3 ] "float scale" .5)") ==
          Json::parse(R"({"type": "constant", "radiance": [0.5, 1.0, 1.5]})"));
    CHECK(light(R"("infinite" "float illuminance" 3)")["radiance"].get<double>() == Approx(3 / kPi));
    // pbrt brings all spectra but "rgb" to a luminance of 1.
    const auto luminanceOf = [](const Json& c) {
        return luminance({c[0].get<double>(), c[1].get<double>(), c[2].get<double>()});
    };
    const Json warm = light(R"("point" "blackbody I" 2856)")["intensity"];
    CHECK(luminanceOf(warm) == Approx(1));
    CHECK(warm[0].get<double>() > 3 * warm[2].get<double>());
    CHECK(light(R"("point" "spectrum I" "stdillum-A")")["intensity"] == warm);
    CHECK(light(R"("point" "spectrum I" "stdillum-D65")")["intensity"] == 1.0);
    CHECK(luminanceOf(light(R"("point" "spectrum I" [ 400 2 500 8 700 4 ] "float scale" 3)")["intensity"]) ==
          Approx(3));
    pbrt.folder.write("l.spd", "# nm value\n400 2\n500 8\n700 4\n");
    CHECK(light(R"("point" "spectrum I" "l.spd" "float scale" 3)") ==
          light(R"("point" "spectrum I" [ 400 2 500 8 700 4 ] "float scale" 3)"));
    CHECK(pbrt.complaint(R"(LightSource "point" "spectrum I" [ 500 1 400 1 ])").has("wavelengths, ascending"));
    CHECK(pbrt.complaint(R"(LightSource "point" "blackbody I" [ 3000 2 ])").has("one temperature"));

    const auto area = [&](const std::string& parameters, const std::string& shape) {
        return entry(pbrt.read("AreaLightSource \"diffuse\" " + parameters + " " + shape),
                     "shape")["emitter"]["radiance"];
    };
    CHECK(area(R"("rgb L" [ 1 2 3 ] "float scale" 2)", "Shape \"sphere\"") == Json({2.0, 4.0, 6.0}));
    CHECK(area(R"("float power" 8)", "Scale 2 2 2 Shape \"sphere\"").get<double>() == Approx(8 / (kPi * 16 * kPi)));
    CHECK(area(R"("float power" 8)", R"(Scale 2 1 1 Shape "disk" "float radius" 3)").get<double>() ==
          Approx(8 / (kPi * 18 * kPi)));
    CHECK(area(R"("float power" 8)",
               R"(Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point3 P" [ 0 0 0 2 0 0 2 2 0 0 2 0 ])")
              .get<double>() == Approx(8 / (kPi * 2)));
    CHECK(pbrt.complaint(
                  R"(AreaLightSource "diffuse" "float power" 8 Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
        "point3 P" [ 0 0 0 2 0 0 2 2 0 0 1 0 ])")
              .has("each triangle of a mesh"));
    CHECK(pbrt.complaint(R"(AreaLightSource "diffuse" "bool twosided" true Shape "sphere")")
              .has("\"twosided\" of light \"diffuse\" is not supported"));
    CHECK(pbrt.complaint(R"(AreaLightSource "diffuse" "string filename" "a.png" Shape "sphere")").has("\"filename\""));
    CHECK(pbrt.complaint(R"(LightSource "infinite" "rgb L" [ 1 1 1 ] "string filename" "a.exr")")
              .has("either \"L\" or \"filename\""));
    CHECK(pbrt.complaint(R"(LightSource "point" "float scal" 1)").has("did you mean \"scale\""));
}

TEST_CASE("octahedral maps: equal areas, and the way back") {
    // Known points: the middle, a corner, the middles of two edges.
    CHECK((octahedralDirection(0.5, 0.5) - Vec3d(0, 0, 1)).length() < 1e-12);
    CHECK((octahedralDirection(0, 0) - Vec3d(0, 0, -1)).length() < 1e-12);
    CHECK((octahedralDirection(1, 0.5) - Vec3d(1, 0, 0)).length() < 1e-12);
    CHECK((octahedralDirection(0.5, 1) - Vec3d(0, 1, 0)).length() < 1e-12);
    constexpr int n = 400;
    Vec3d first(0.0), second(0.0);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double u = (i + 0.5) / n, v = (j + 0.5) / n;
            const Vec3d w = octahedralDirection(u, v);
            CHECK_FALSE(std::abs(w.length() - 1) > 1e-12);
            const Sample2 back = octahedralPoint(w);
            CHECK_FALSE(std::hypot(back.u - u, back.v - v) > 1e-6);
            first += w / (n * n);
            second += w * w / (n * n);
        }
    // Moments of the uniform distribution over the sphere.
    CHECK(first.length() < 1e-9);
    for (int c = 0; c < 3; ++c) CHECK(second[c] == Approx(1.0 / 3).epsilon(1e-4));
}

TEST_CASE("pbrt: an environment shines from where pbrt has it") {
    const PbrtScene pbrt;
    Image square(64, 64);
    // One octant bright: x, y > 0 and z > 0 lies in the picture's middle, to the right and below.
    for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) {
            const Vec3d w = octahedralDirection((i + 0.5) / 64, (j + 0.5) / 64);
            square.at(i, j) = w.x > 0 && w.y > 0 && w.z > 0 ? Rgb(8.0f) : Rgb(0.25f);
        }
    CHECK(square.at(40, 40).x == 8.0f);
    CHECK(square.at(24, 40).x == 0.25f);
    writeExr((pbrt.folder.path / "sky.exr").string(), square);
    const auto seen = [&](const std::string& state, const Vec3f& w) {
        const Scene scene = pbrt.loadWorld(
            state +
            " LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 2 Identity Shape \"sphere\"");
        return std::get<EnvmapEmitter>(scene.emitters[0]).map->radiance(normalize(w)).x;
    };
    CHECK(seen("", {1, 1, 1}) == Approx(16));
    CHECK(seen("", {-1, 1, 1}) == Approx(0.5));
    CHECK(seen("", {1, 1, -1}) == Approx(0.5));
    CHECK(seen("Rotate 90 0 0 1", {-1, 1, 1}) == Approx(16));  // (1,1,1) turned by 90 degrees around z
    CHECK(seen("Scale -1 1 1", {-1, 1, 1}) == Approx(16));
    CHECK(seen("Translate 5 0 0 Rotate -90 1 0 0", {1, 1, -1}) == Approx(16));
    const Scene scene = pbrt.loadWorld("LightSource \"infinite\" \"string filename\" \"sky.exr\" Shape \"sphere\"");
    // All texels have the same solid angle.
    double sum = 0;
    for (const Rgb& pixel : square.pixels) sum += pixel.x;
    CHECK(std::get<EnvmapEmitter>(scene.emitters[0]).map->totalLuminance() ==
          Approx(4 * kPi * sum / (64 * 64)).epsilon(2e-3));
    writeExr((pbrt.folder.path / "flat.exr").string(), Image(4, 2, Rgb(1.0f)));
    CHECK(errorOf([&] {
              pbrt.loadWorld("LightSource \"infinite\" \"string filename\" \"flat.exr\" Shape \"sphere\"");
          }).has("is square, not 4 x 2"));
}

TEST_CASE("pbrt: Loop's subdivision surfaces") {
    using pbrt::subdivide;
    const std::vector<Vec3d> corners{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const std::vector<std::array<int, 3>> octahedron{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    const auto coarse = subdivide(corners, octahedron, 0);
    // Four neighbours in a plane: (1 − 4γ) with γ = 1/(4 + 3/(8β)), β = 3/32.
    CHECK((coarse.positions[0] - Vec3d(0.5, 0, 0)).length() < 1e-12);
    const auto fine = subdivide(corners, octahedron, 3);
    CHECK(fine.triangles.size() == 8 * 64);
    CHECK(fine.positions.size() == 258);
    for (int i = 0; i < 6; ++i)
        CHECK((fine.positions[size_t(i)] - coarse.positions[size_t(i)]).length() < 1e-12);  // limits stay
    for (size_t i = 0; i < fine.positions.size(); ++i) {
        // The triangles are counter-clockwise from outside; pbrt's normals are on the other side.
        CHECK(fine.normals[i].dot(fine.positions[i].normalized()) < -0.95);
    }
    // A flat sheet stays flat, its border smooth; a corner of two neighbours is drawn along the border.
    const auto sheet = subdivide({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}, 2);
    for (const Vec3d& n : sheet.normals) CHECK((n - Vec3d(0, 0, -1)).length() < 1e-9);
    CHECK((sheet.positions[1] - Vec3d(1.6, 0.4, 0)).length() > 0.05);
    CHECK((subdivide({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}, 0).positions[1] -
           Vec3d(1.6, 0.4, 0))
              .length() < 1e-12);
    CHECK_THROWS_AS(subdivide(corners, {{0, 2, 4}, {0, 2, 5}}, 1), pbrt::NoSurface);
    CHECK_THROWS_AS(subdivide({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}, 0),
                    pbrt::NoSurface);
    const PbrtScene scene;
    CHECK(
        scene
            .complaint(
                R"(Shape "loopsubdiv" "integer levels" 30 "integer indices" [ 0 1 2 ] "point3 P" [ 0 0 0 1 0 0 0 1 0 ])")
            .has("are too many"));
    CHECK(
        faceNormal(
            scene.loadWorld(
                R"(LightSource "point" Shape "loopsubdiv" "integer levels" 1 "integer indices" [ 0 1 2 ] "point3 P" [ 0 0 0 1 0 0 0 1 0 ])"),
            0)
            .z == -1);
}

TEST_CASE("pbrt: a large mesh written out is read in time that grows with it") {
    const PbrtScene pbrt;
    const auto seconds = [&](int n) {
        std::string text =
            "Camera \"perspective\" WorldBegin LightSource \"point\" Shape \"trianglemesh\" \"point3 P\" [";
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) text += fmt::format(" {} {} {}", i, j, 0.01 * ((i * j) % 7));
        text += "] \"integer indices\" [";
        for (int j = 0; j + 1 < n; ++j)
            for (int i = 0; i + 1 < n; ++i) {
                const int a = j * n + i, b = a + n;
                text += fmt::format(" {} {} {} {} {} {}", a, a + 1, b, a + 1, b + 1, b);
            }
        text += "]";
        pbrt.folder.write("scene.pbrt", text);
        const auto start = std::chrono::steady_clock::now();
        const Scene scene = SceneDescription::fromFile(pbrt.folder.path / "scene.pbrt").build();
        CHECK(std::get<Mesh>(scene.shapes[0].geometry).positions.size() == size_t(n) * size_t(n));
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const double small = seconds(125), large = seconds(500);
    INFO(small << " s, " << large << " s");
    CHECK(large < 64 * small);  // 16 times the vertices; quadratic would be 256 times the time
}
