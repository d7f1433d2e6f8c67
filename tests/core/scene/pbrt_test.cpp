// Scenes of pbrt-v4 as dictionaries: directives, transformations, cameras, files, and what is refused.

#include <random>

#include "tests/core/scene/pbrt_scene.h"

using namespace ulam;

namespace {

/// Where a point of the world is seen, in pixels.
Vec2f seen(const Scene& scene, const Vec3f& point) {
    const Vertex lens = scene.sensor->lensPoint({0, 0});
    const auto response = scene.sensor->respond(lens, normalize(point - lens.position));
    INFO(point.x << " " << point.y << " " << point.z);
    REQUIRE(response.importance > 0);
    return response.raster;
}

void isNear(const Vec2f& a, double x, double y) {
    CHECK(a.x == Approx(x).margin(1e-3));
    CHECK(a.y == Approx(y).margin(1e-3));
}

const char* const kLit = "LightSource \"point\"\nShape \"sphere\"\n";

}  // namespace

TEST_CASE("pbrt: a basic scene is the dictionary that one would write") {
    const Json scene = PbrtScene{}
                           .readFile(R"(# remark
        Option "disablepixeljitter" true
        Integrator "volpath" "integer maxdepth" 5   Sampler "zsobol"   Accelerator "bvh"   ColorSpace "srgb"
        Film "rgb" "integer xresolution" 64 "integer yresolution" [ 48 ] "string filename" "a.exr"
        PixelFilter "box"
        Translate 0 0 5
        Camera "perspective" "float fov" 40
        WorldBegin
        AttributeBegin
          Material "diffuse" "rgb reflectance" [ .1 .2 .3 ]
          Translate 1 2 3
          Shape "sphere" "float radius" 2
        AttributeEnd
        LightSource "point" "point3 from" [ 0 4 0 ] "rgb I" [ 5 6 7 ])")
                           .json();
    CHECK(scene == Json::parse(R"({"type": "scene",
        "sensor": {"type": "perspective", "fov": 40.0, "fov_axis": "smaller",
                   "to_world": [-1.0, 0.0, 0.0, 0.0,  0.0, 1.0, 0.0, 0.0,  0.0, 0.0, 1.0, -5.0,  0.0, 0.0, 0.0, 1.0],
                   "film": {"type": "hdrfilm", "width": 64, "height": 48, "rfilter": {"type": "box"}}},
        "integrator": {"type": "volpath"}, "sampler": {"type": "zsobol"}, "accelerator": {"type": "bvh"},
        "material": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": [0.1, 0.2, 0.3]}},
        "shape": {"type": "sphere", "radius": 2.0,
                  "to_world": [1.0, 0.0, 0.0, 1.0,  0.0, 1.0, 0.0, 2.0,  0.0, 0.0, 1.0, 3.0,  0.0, 0.0, 0.0, 1.0],
                  "bsdf": {"type": "ref", "id": "material"}},
        "light": {"type": "point", "position": [0.0, 4.0, 0.0], "intensity": [5.0, 6.0, 7.0]}})"));
}

TEST_CASE("pbrt: the image is not mirrored, and has pbrt's angle of view") {
    const PbrtScene pbrt;
    const std::string film = "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n";
    // pbrt's camera has x to the right, y up and looks along z; fov spans the shorter axis: |y| ≤ z at 90 degrees.
    const Scene plain = pbrt.load(film + "Camera \"perspective\"\nWorldBegin\n" + kLit);
    isNear(seen(plain, {0, 0, 4}), 100, 50);
    isNear(seen(plain, {4, 0, 4}), 150, 50);
    isNear(seen(plain, {0, 4, 8}), 100, 25);
    const Scene tall = pbrt.load(
        "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 200\nCamera \"perspective\"\nWorldBegin\n" +
        std::string(kLit));
    isNear(seen(tall, {2, 4, 4}), 75, 50);
    // Seen from +x towards -x in a left-handed world with y up: +z is to the right.
    const Scene side = pbrt.load(film + "LookAt 5 0 0  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n" + kLit);
    isNear(seen(side, {0, 0, 5}), 150, 50);
    // A mirrored world, as exporters from right-handed programs write it.
    const Scene mirrored =
        pbrt.load(film + "Scale -1 1 1\nLookAt 5 0 0  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n" + kLit);
    isNear(seen(mirrored, {0, 0, 5}), 50, 50);
    // A camera in a scaled world sees the same.
    const Scene scaled = pbrt.load(film + "Scale 3 3 3\nCamera \"perspective\"\nWorldBegin\n" + kLit);
    isNear(seen(scaled, {4, 0, 4}), 150, 50);
    // The window's left edge at 0, its right one at 2, in units of tan(fov/2) = 1.
    const Scene shifted =
        pbrt.load(film + "Camera \"perspective\" \"float screenwindow\" [ 0 2 -.25 .75 ]\nWorldBegin\n" + kLit);
    isNear(seen(shifted, {1, 0.25f, 1}), 100, 50);
    isNear(seen(shifted, {0.5f, 0.5f, 1}), 50, 25);
}

TEST_CASE("pbrt: crops of the film, its filters, and what has no effect") {
    const PbrtScene pbrt;
    const auto sensor = [&](const std::string& settings) {
        return entry(pbrt.readFile(settings + "\nWorldBegin\n"), "sensor");
    };
    const Json crop = sensor(R"(Camera "perspective" "float lensradius" 0.5 "float focaldistance" 3
        Film "gbuffer" "integer xresolution" 100 "integer yresolution" 50 "float cropwindow" [ .25 .5 0 .5 ] "float iso" 200
        PixelFilter "triangle" "float xradius" 1.5 "float yradius" 1.5)");
    CHECK(crop["type"] == "thinlens");
    CHECK(crop["aperture_radius"] == 0.5);
    CHECK(crop["focus_distance"] == 3.0);
    CHECK(crop["film"] ==
          Json::parse(R"({"type": "gbuffer", "width": 100, "height": 50, "crop_offset_x": 25, "crop_offset_y": 0,
        "crop_width": 25, "crop_height": 25, "rfilter": {"type": "tent", "radius": 1.5}, "iso": 200.0})"));
    const Json bounds =
        sensor(R"(Camera "perspective" Film "rgb" "integer pixelbounds" [ 10 20 5 7 ] PixelFilter "mitchell")");
    CHECK(bounds["film"]["crop_offset_x"] == 10);
    CHECK(bounds["film"]["crop_height"] == 2);
    CHECK(bounds["film"]["width"] == 1280);
    CHECK(bounds["film"]["rfilter"]["type"] == "mitchell");
    CHECK(sensor("Camera \"perspective\" \"float shutterclose\" 0.5")["film"]["exposure_time"] == 0.5);
    CHECK(sensor("Camera \"perspective\"")["film"]["rfilter"] == Json::parse(R"({"type": "gaussian", "stddev": 0.5})"));

    const Scene scene =
        pbrt.load("Camera \"perspective\"\nFilm \"gbuffer\" \"float iso\" 50\nIntegrator \"mlt\"\nWorldBegin\n" +
                  std::string(kLit));
    std::string warnings;
    for (const std::string& warning : scene.warnings) warnings += warning + "\n";
    CHECK(mentions(warnings, "\"iso\" has no effect, at " + (pbrt.folder.path / "scene.pbrt").string() + ":2:1"));
    CHECK(mentions(warnings, "\"gbuffer\" is taken for an hdrfilm"));
    CHECK(mentions(warnings, "\"mlt\" has no effect"));
}

TEST_CASE("pbrt: transformations, and what of the state ends with its block") {
    const PbrtScene pbrt;
    const auto place = [&](const std::string& directives) {
        const Scene scene = pbrt.loadWorld(directives + "\nLightSource \"point\" \"point3 from\" [ 1 0 0 ]");
        return std::get<PointEmitter>(scene.emitters[0]).position;
    };
    const auto is = [](const Vec3f& p, float x, float y, float z) {
        INFO(p.x << " " << p.y << " " << p.z);
        CHECK(length(p - Vec3f(x, y, z)) < 1e-5f);
    };
    is(place(""), 1, 0, 0);
    is(place("Translate 1 2 3 Scale 2 3 4"), 3, 2, 3);
    is(place("Scale 2 3 4 Translate 1 2 3"), 4, 6, 12);
    is(place("Rotate 90 0 0 1"), 0, 1, 0);
    is(place("Transform [ 0 0 1 0  0 1 0 0  -1 0 0 0  5 6 7 1 ]"), 5, 6, 8);
    is(place("Translate 1 0 0 ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1 ]"), 7, 6, 7);
    is(place("Translate 1 0 0 Identity"), 1, 0, 0);
    is(place("LookAt 0 0 5  0 0 0  0 1 0"), -1, 0, 5);
    is(place("Translate 1 0 0 CoordinateSystem \"here\" Identity CoordSysTransform \"here\""), 2, 0, 0);
    is(place("AttributeBegin Translate 1 0 0 AttributeEnd"), 1, 0, 0);
    is(place("TransformBegin Translate 1 0 0 TransformEnd TransformTimes 0 1 ActiveTransform All"), 1, 0, 0);
    const Scene camera = pbrt.load(
        "Translate 0 0 5 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\" LightSource \"point\"");
    is(std::get<PointEmitter>(camera.emitters[0]).position, 0, 0, -5);

    const auto scene = pbrt.read(R"(Attribute "shape" "float radius" 3
        AttributeBegin Material "dielectric" AreaLightSource "diffuse" ReverseOrientation Attribute "shape" "float radius" 4
        Shape "sphere" Shape "sphere" "float radius" 5 AttributeEnd
        TransformBegin Material "conductor" TransformEnd Shape "sphere")");
    CHECK(entry(scene, "shape")["radius"] == 4.0);
    CHECK(entry(scene, "shape")["flip_normals"] == true);
    CHECK(entry(scene, "shape_2")["radius"] == 5.0);
    CHECK(entry(scene, "shape_3")["radius"] == 3.0);
    CHECK(!entry(scene, "shape_3").contains("emitter"));
    CHECK(entry(scene, "shape_3")["bsdf"]["id"] == "material_2");  // TransformEnd restores the transformation alone
}

TEST_CASE("pbrt: included files, and their places") {
    const PbrtScene pbrt;
    pbrt.folder.write("ball.pbrt", "Translate 1 0 0\nMaterial \"conductor\"\n\n  Shape \"sphere\"");
    const Complaint missing = pbrt.complaint("Include \"none.pbrt\"");
    CHECK(missing.has("there is no file \"none.pbrt\" at"));
    CHECK(missing.has("scene.pbrt:3:1"));
    CHECK(pbrt.complaint("Include \"../up.pbrt\"").has("leaves the folder"));
    CHECK(pbrt.complaint("Include \"/etc/passwd\"").has("leaves the folder"));
    CHECK(pbrt.complaint("Shape \"plymesh\" \"string filename\" \"../x.ply\"").has("leaves the folder"));
    CHECK(pbrt.complaint("LightSource \"point\" \"spectrum I\" \"../x.spd\"").has("leaves the folder"));
    const auto both = pbrt.read("Import \"ball.pbrt\" Shape \"sphere\" Include \"ball.pbrt\" Shape \"sphere\"");
    CHECK(entry(both, "shape")["to_world"][3] == 1.0);
    CHECK(!entry(both, "shape_2").contains("to_world"));  // what is imported keeps to itself
    CHECK(entry(both, "shape_4")["to_world"][3] == 1.0);
    CHECK(both.root().at("shape").where().find("ball.pbrt:4:3 (/shape)") != std::string::npos);
    CHECK(both.root().at("shape_2").where().find("scene.pbrt:3:20 (/shape_2)") != std::string::npos);
    pbrt.folder.write("loop.pbrt", "Include \"loop.pbrt\"");
    CHECK(pbrt.complaint("Include \"loop.pbrt\"").has("\"loop.pbrt\" includes itself at"));
    for (int i = 0; i < 20; ++i) pbrt.folder.write(fmt::format("chain{}.pbrt", i), fmt::format("Include \"chain{}.pbrt\"", i + 1));
    CHECK(pbrt.complaint("Include \"chain0.pbrt\"").has("include each other deeper than 15"));
    pbrt.folder.write("open.pbrt", "AttributeBegin");
    CHECK(pbrt.complaint("Import \"open.pbrt\"").has("Import ends inside Attribute"));
    pbrt.folder.write("close.pbrt", "AttributeEnd");
    CHECK(pbrt.complaint("AttributeBegin Import \"close.pbrt\"").has("Attribute ends inside Import"));
}

TEST_CASE("pbrt: mistakes are refused with their place and the nearest name") {
    const PbrtScene pbrt;
    const auto refused = [&](const std::string& world, const std::string& message, const std::string& place) {
        const Complaint complaint = pbrt.complaint(world);
        INFO(world << "\n" << complaint.message);
        CHECK(complaint.code == ExitCode::InvalidConfig);
        CHECK(complaint.has(message));
        CHECK(complaint.has("scene.pbrt:" + place));
    };
    refused("\n  Shaep \"sphere\"", "unknown directive \"Shaep\"", "4:3");
    refused("Shaep \"sphere\"", "did you mean \"Shape\"", "3:1");
    refused("WorldEnd", "pbrt-v3", "3:1");
    refused("Shape \"sphre\"", "unknown shape \"sphre\"", "3:1");
    refused("Shape \"sphre\"", "did you mean \"sphere\"", "3:1");
    refused("LightSource \"pint\"", "did you mean \"point\"", "3:1");
    refused("Material \"difuse\" Shape \"sphere\"", "did you mean \"diffuse\"", "3:1");
    refused("MakeNamedMaterial \"a\" \"string type\" \"difuse\"", "did you mean \"diffuse\"", "3:1");
    refused("MakeNamedMaterial \"a\"", "has no \"type\"", "3:1");
    refused("MakeNamedMaterial \"gold\" \"string type\" \"diffuse\" NamedMaterial \"gld\" Shape \"sphere\"",
            "did you mean \"gold\"", "3:");
    refused("Texture \"a\" \"spectrum\" \"imagmap\"", "did you mean \"imagemap\"", "3:1");
    refused("Texture \"a\" \"colour\" \"constant\"", "unknown kind of texture", "3:1");
    refused("Material \"diffuse\" \"texture reflectance\" \"wood\" Shape \"sphere\"", "unknown texture \"wood\"",
            "3:20");
    refused("Shape \"sphere\" \"float radus\" 2", "did you mean \"radius\"", "3:16");
    refused("Shape \"sphere\" \"integer radius\" 2", "is of type float, found integer", "3:16");
    refused("Shape \"sphere\" \"flot radius\" 2", "did you mean \"float\"", "3:16");
    refused("Shape \"sphere\" \"radius\" 2", "a type and a name", "3:16");
    refused("Shape \"sphere\" \"float radius\" \"2\"", "expected a number", "3:31");
    refused("Shape \"sphere\" \"float radius\" 2x", "expected a number", "3:31");
    refused("Shape \"sphere\" \"float radius\" nan", "expected a number", "3:31");
    refused("Shape \"sphere\" \"float radius\" 1e999", "expected a number", "3:31");
    refused("Shape \"sphere\" \"float radius\" [ 1 2 ]", "is one value", "3:16");
    refused("Shape \"sphere\" \"float radius\" []", "is one value", "3:16");
    refused("Shape \"sphere\" \"float radius\" 1 \"float radius\" 1", "given twice", "3:");
    refused("Shape \"sphere\" \"float radius\" [ 1", "the end of the file", "4:1");
    refused("Shape \"sphere\" \"float radius", "no closing quote", "3:16");
    refused("Shape \"loopsubdiv\" \"integer levels\" 1.5", "a whole number", "3:37");
    refused("Shape \"trianglemesh\" \"point3 P\" [ 1 2 3 4 ]", "3 numbers each", "3:22");
    refused("LightSource \"point\" \"bool scale\" \"true\"", "true or false, without quotes", "3:34");
    refused("\"sphere\"", "expected a directive", "3:1");
    refused("Shape sphere", "a shape in quotes", "3:7");
    refused("AttributeEnd", "no AttributeBegin", "3:1");
    refused("AttributeBegin TransformEnd", "Transform ends inside Attribute", "3:16");
    refused("AttributeBegin", "AttributeBegin has no AttributeEnd", "3:1");
    refused("Scale 1 0 1", "not invertible", "3:1");
    refused("Rotate 30 0 0 0", "has no length", "3:1");
    refused("LookAt 0 0 0 0 1 0 0 1 0", "not along the view", "3:1");
    refused("Transform [ 1 2 3 ]", "a number for Transform", "3:19");
    refused("CoordSysTransform \"camra\"", "did you mean \"camera\"", "3:1");
    refused("ActiveTransform StartTime", "moving scenes", "3:1");
    refused("ColorSpace \"rec2020\"", "is not supported", "3:1");
    refused("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"", "a medium is not supported", "3:1");
    refused("MediumInterface \"fog\" \"\"", "a medium is not supported", "3:1");
    refused("Camera \"perspective\"", "before WorldBegin", "3:1");
    refused("WorldBegin", "one WorldBegin", "3:1");
    refused("ObjectInstance \"a\"", "unknown object \"a\"", "3:1");
    refused("ObjectBegin \"a\" AreaLightSource \"diffuse\" Shape \"sphere\" ObjectEnd", "a light in an object", "3:");
    refused("MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"a\" \"string type\" \"diffuse\"",
            "another material", "3:");
    CHECK(pbrt.read("MediumInterface \"\" \"\" MediumInterface \"\"").json().size() == 2);
    CHECK(errorOf([&] { pbrt.readFile("WorldBegin"); }).has("the scene has no Camera"));
    CHECK(errorOf([&] { pbrt.readFile("Camera \"perspective\""); }).has("the scene has no WorldBegin"));
    CHECK(errorOf([&] { pbrt.readFile("Shape \"sphere\""); }).has("after WorldBegin"));
    CHECK(errorOf([&] { pbrt.readFile("Camera \"orthographic\" WorldBegin"); }).has("unknown camera"));
    CHECK(errorOf([&] {
              pbrt.readFile("Camera \"perspective\" \"float fov\" 180 WorldBegin");
          }).has("between 0 and 180"));
    CHECK(errorOf([&] {
              pbrt.readFile("Camera \"perspective\" \"float frameaspectratio\" 3 WorldBegin");
          }).has("not square"));
    CHECK(errorOf([&] {
              pbrt.readFile("Film \"rgb\" \"integer xresolution\" 0 Camera \"perspective\" WorldBegin");
          }).has("at least one pixel"));
    CHECK(errorOf([&] { pbrt.readFile(std::string("Camera \0", 8)); }).has("a zero byte"));
    CHECK(errorOf([&] { pbrt.read("Include \"\xff.pbrt\""); }).has("is not UTF-8"));
    const Complaint defined = errorOf([&] {
        readSceneDocument(pbrt.folder.path / "scene.pbrt", {.definitions = {{"a", "1"}}});
    });
    CHECK(defined.code == ExitCode::Usage);
    std::string deep;
    for (int i = 0; i < 2000; ++i) deep += "AttributeBegin ";
    CHECK(pbrt.complaint(deep).has("nested deeper than"));
}

TEST_CASE("pbrt: --lenient replaces what is not known and says so") {
    const PbrtScene pbrt;
    const Scene scene = [&] {
        pbrt.folder.write("scene.pbrt", R"(Camera "perspective" WorldBegin
            LightSource "goniometric" "string filename" "a.exr"
            LightSource "point"
            Shape "curve" "point3 P" [ 0 0 0 1 0 0 2 0 0 3 0 0 ]
            Texture "t" "spectrum" "marble" "float scale" 3
            Material "diffuse" "texture reflectance" "t" "string normalmap" "n.png"
            Shape "sphere"
            Material "hair" "float eta" 1.5
            Shape "sphere")");
        return SceneDescription::fromNode(
                   readSceneDocument(pbrt.folder.path / "scene.pbrt", {.definitions = {}, .lenient = true}).root(),
                   pbrt.folder.path)
            .build();
    }();
    REQUIRE(scene.shapes.size() == 2);
    REQUIRE(scene.substitutions.size() == 5);
    std::string all;
    for (const std::string& s : scene.substitutions) all += s + "\n";
    for (const char* part : {"the light \"goniometric\" at", "scene.pbrt:2:13 is not known: it is left out",
                             "the shape \"curve\" at", "the texture \"marble\" at", "the material \"hair\" at",
                             "scene.pbrt:8:13 is not known: magenta", "\"normalmap\" of material \"diffuse\""})
        CHECK(mentions(all, part));
    CHECK(pbrt.complaint("LightSource \"goniometric\"").has("unknown light"));
    CHECK(pbrt.complaint("Material \"diffuse\" \"string normalmap\" \"n.png\" Shape \"sphere\"")
              .has("\"normalmap\" of material \"diffuse\" is not supported"));
}

TEST_CASE("pbrt: truncated and damaged files give a scene or an error") {
    const PbrtScene pbrt;
    pbrt.folder.write("a.pbrt", "Shape \"sphere\"");
    const std::string text =
        R"(LookAt 0 0 5 0 0 0 0 1 0 Camera "perspective" "float fov" [ 40 ] Film "rgb" "integer xresolution" 8
        WorldBegin AttributeBegin Texture "c" "spectrum" "checkerboard" "rgb tex1" [ 1 0 .5 ] Material "diffuse" "texture reflectance" "c"
        Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ] AttributeEnd Include "a.pbrt"
        ObjectBegin "o" Shape "loopsubdiv" "integer levels" 1 "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ] ObjectEnd
        Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 2 3 4 1 ] ObjectInstance "o" AreaLightSource "diffuse" "blackbody L" 3000 "float power" 5
        Shape "disk" LightSource "spot" "float coneangle" 30 MakeNamedMaterial "m" "string type" "coateddiffuse" NamedMaterial "m")";
    size_t scenes = 0, errors = 0;
    const auto attempt = [&](const std::string& damaged) {
        const Complaint complaint = errorOf([&] { pbrt.readFile(damaged); });
        complaint.message.empty() ? ++scenes : ++errors;
    };
    for (size_t length = 0; length <= text.size(); ++length) attempt(text.substr(0, length));
    CHECK(scenes > 10);
    CHECK(errors > 500);
    std::mt19937 random(7);
    for (int i = 0; i < 1000; ++i) {
        std::string damaged = text;
        for (int flips = 1 + int(random() % 3); flips > 0; --flips) damaged[random() % damaged.size()] = char(random());
        attempt(damaged);
    }
    CHECK(errors > 1000);
}
