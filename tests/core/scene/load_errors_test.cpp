// Mistakes in scenes: each gives an error that names place and remedy.

#include "core/base/random.h"
#include "core/image/image_io.h"
#include "core/scene/loading/scene_file.h"
#include "core/scene/plugins.h"
#include "tests/core/scene/load_text.h"

using namespace ulam;

TEST_CASE("unknown names are answered with the nearest one") {
    const auto expect = [](const std::string& entries, const std::string& place, const std::string& nearest) {
        const std::string message = errorOf(sceneWith(entries));
        INFO(message);
        CHECK(mentions(message, "scene.json:1:"));
        CHECK(mentions(message, place));
        CHECK(mentions(message, "did you mean \"" + nearest + "\""));
    };
    expect(R"("s": {"type": "sphere", "radiuss": 2})", "/s/radiuss", "radius");
    expect(R"("s": {"type": "shpere"})", "/s/type", "sphere");
    expect(R"("s": {"type": "sphere", "bsdf": {"type": "difuse"}})", "/s/bsdf", "diffuse");
    expect(R"("s": {"type": "sphere", "bsdf": {"type": "conducter"}})", "/s/bsdf", "conductor");
    expect(R"("s": {"type": "sphere", "bsdf": {"type": "diffuse", "reflectence": 1}})", "/s/bsdf/reflectence",
           "reflectance");
    expect(R"("s": {"type": "sphere", "bsdf": {"type": "dielectric", "int_ior": "bk8"}})", "/s/bsdf/int_ior", "bk7");
    expect(R"("glass": {"type": "dielectric"}, "s": {"type": "sphere", "bsdf": {"type": "ref", "id": "glas"}})",
           "/s/bsdf/id", "glass");
    expect(R"("e": {"type": "constan"})", "/e", "constant");
}

TEST_CASE("films and filters of others are noted and replaced") {
    const Scene scene = loadText(R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "perspective",
        "film": {"type": "ldrfilm", "width": 5, "height": 4, "rfilter": {"type": "mitchell", "B": 0.2}}}})");
    CHECK(scene.sensor->width() == 5);
    REQUIRE(scene.warnings.size() == 2);
    CHECK(mentions(scene.warnings[0], "the film \"ldrfilm\" is taken for an hdrfilm, at scene.json:2:"));
    CHECK(mentions(scene.warnings[1], "a gaussian takes the place of the reconstruction filter \"mitchell\""));
    CHECK(scene.filter.radius() == ReconstructionFilter(ReconstructionFilter::GaussianParameters{}).radius());
}

TEST_CASE("textures: missing, damaged, of another format, out of range, or where none may stand") {
    const SceneFolder folder("texture_errors");
    const auto picture = [&](const std::string& name, Rgb value) { writeExr((folder.path / name).string(), Image(4, 4, value)); };
    picture("bright.exr", Rgb(1.5f)), picture("negative.exr", Rgb(-0.5f)), picture("black.exr", Rgb(0));
    folder.write("text.png", "no picture");
    folder.write("a.bmp", "no picture");
    folder.write("nan.pfm", std::string("PF\n1 1\n-1.0\n") + std::string("\0\0\xc0\x7f", 4) + std::string(8, '\0'));
    const auto of = [&](const std::string& texture, ExitCode code = ExitCode::InvalidConfig) {
        return errorOf(sceneWith(R"("s": {"type": "cube", "bsdf": {"type": "diffuse", "reflectance": )" + texture + "}}"), code, folder.path);
    };
    const auto file = [&](const std::string& name, ExitCode code = ExitCode::InvalidConfig) {
        return of(R"({"type": "bitmap", "filename": ")" + name + "\"}", code);
    };
    for (const char* name : {"text.png", "a.bmp", "nan.pfm", "../black.exr"}) CHECK(mentions(file(name), "/s/bsdf/reflectance/filename"));
    CHECK(mentions(file("none.png", ExitCode::InputMissing), "/s/bsdf/reflectance/filename"));
    CHECK(mentions(file("bright.exr"), "at most 1"));
    CHECK(mentions(file("negative.exr"), "below 0"));
    CHECK(mentions(of(R"({"type": "bitmap"})"), "filename"));
    CHECK(mentions(of(R"({"type": "bitmat", "filename": "black.exr"})"), "bitmap"));
    CHECK(mentions(of(R"({"type": "checkerboard", "color2": 1})"), "color1"));
    CHECK(mentions(of(R"({"type": "checkerboard", "to_uv": [{"type": "scale", "value": 0}]})"), "not invertible"));
    CHECK(mentions(of(R"({"type": "ref", "id": "light"})"), "no texture"));
    CHECK(mentions(errorOf(sceneWith(R"("p": {"type": "point", "intensity": {"type": "checkerboard"}})")), "checkerboard"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "b": {"type": "dielectric", "int_ior": {"type": "checkerboard"}}})")), "takes no texture"));
    const auto sky = [&](const std::string& parameters) {
        return errorOf(sceneWith(R"("sky": {"type": "envmap", )" + parameters + "}"), ExitCode::InvalidConfig, folder.path);
    };
    CHECK(mentions(sky(R"("filename": "black.exr")"), "no light"));
    CHECK(mentions(sky(R"("filename": "bright.exr", "scale": 0)"), "no light"));
    CHECK(mentions(sky(R"("filename": "negative.exr")"), "negative"));
    CHECK(mentions(sky(R"("filename": "bright.exr", "to_world": [{"type": "scale", "value": [1,2,1]}])"), "keep angles"));
    CHECK(mentions(sky(R"("scale": 1)"), "filename"));
}

TEST_CASE("lights, lenses and shapes that make no sense") {
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "spot", "cutoff_angle": 0})")), "/s/cutoff_angle"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "spot", "cutoff_angle": 10, "beam_width": 20})")), "wider than"));
    CHECK(mentions(errorOf(sceneWith(R"("d": {"type": "directional", "direction": [0,0,0]})")), "longer than 0"));
    CHECK(mentions(errorOf(sceneWith(R"("d": {"type": "directional", "direction": [0,0,1], "to_world": [{"type": "scale", "value": 2}]})")), "either"));
    const auto lens = [](const std::string& parameters) {
        return errorOf(R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "thinlens")" + parameters + "}}");
    };
    CHECK(mentions(lens(""), "aperture_radius"));
    CHECK(mentions(lens(R"(, "aperture_radius": 0.1)"), "focus_distance"));
    CHECK(mentions(lens(R"(, "aperture_radius": 0.1, "focus_distance": 0)"), "/sensor/focus_distance"));
    CHECK(mentions(lens(R"(, "aperture_radius": 0, "focus_distance": 1)"), "perspective"));
    CHECK(mentions(errorOf(sceneWith(R"("c": {"type": "cylinder", "p0": [1,1,1], "p1": [1,1,1]})")), "no length"));
    CHECK(mentions(errorOf(sceneWith(R"("c": {"type": "cylinder", "to_world": [{"type": "scale", "value": [1,2,1]}]})")), "round"));
    CHECK(mentions(errorOf(sceneWith(R"("m": {"type": "mask", "opacity": 0.5})")), "one BSDF"));
    CHECK(mentions(errorOf(sceneWith(R"("m": {"type": "mask", "opacity": 2, "b": {"type": "diffuse"}})")), "/m/opacity"));
    CHECK(mentions(errorOf(sceneWith(R"("t": {"type": "twosided", "b": {"type": "mask", "c": {"type": "diffuse"}}})")), "transmits"));
}

TEST_CASE("values out of range or of the wrong type") {
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "sphere", "radius": 0})")), "/s/radius"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "sphere", "radius": "big"})")), "/s/radius"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "sphere", "center": [1, 2]})")), "/s/center"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "sphere", "radius": 1e39})")), "beyond 1e+15"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "sphere", "to_world": [{"type": "scale", "value": [1,2,1]}]})")),
                   "uniform scale"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "bsdf": {"type": "diffuse", "reflectance": 1.5}})")),
                   "/s/bsdf/reflectance"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "bsdf": 3})")), "\"bsdf\""));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "to_world": [{"type": "scale", "value": 0}]})")),
                   "not invertible"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "to_world": [{"type": "scale", "value": 1e20}]})")),
                   "not finite"));
    CHECK(mentions(errorOf(sceneWith(R"("p": {"type": "point", "position": [0, 1e16, 0]})")), "/p/position"));
    CHECK(mentions(errorOf(sceneWith(R"("s": 1)")), "/s"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube"}, "s": {"type": "cube"})")), "\"s\""));
}

TEST_CASE("meshes with nothing in them or indices astray") {
    CHECK(mentions(errorOf(sceneWith(R"("m": {"type": "mesh", "positions": [], "triangles": []})")), "no triangles"));
    CHECK(mentions(
        errorOf(sceneWith(R"("m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 2,0,0], "triangles": [0,1,2]})")),
        "no triangles"));
    CHECK(mentions(
        errorOf(sceneWith(R"("m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,3]})")),
        "/m/triangles/2"));
    CHECK(
        mentions(errorOf(sceneWith(R"("m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1]})")),
                 "three vertex numbers"));
    CHECK(mentions(
        errorOf(sceneWith(
            R"("m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2], "normals": [0,0,1]})")),
        "one a vertex"));
    CHECK(mentions(
        errorOf(sceneWith(R"("m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1e39,0], "triangles": [0,1,2]})")),
        "not finite"));
    CHECK(mentions(errorOf(sceneWith(R"("m": {"type": "mesh", "triangles": [0,1,2]})")), "\"positions\" is missing"));
}

TEST_CASE("files: missing, damaged, or outside the scene's folder") {
    const SceneFolder folder("errors_test");
    folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    folder.write("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n");
    const auto load = [&](const std::string& file, ExitCode code = ExitCode::InvalidConfig) {
        return errorOf(sceneWith(R"("m": {"type": "obj", "filename": ")" + file + "\"}"), code, folder.path);
    };
    CHECK(mentions(load("bad.obj"), "bad.obj:4"));
    CHECK(mentions(load("nan.obj"), "not finite"));
    const std::string missing = load("missing.obj", ExitCode::InputMissing);
    CHECK(mentions(missing, "missing.obj"));
    CHECK(mentions(missing, "/m/filename"));
    for (const char* path : {"../a.obj", "a/../../a.obj", "/etc/passwd"})
        CHECK(mentions(load(path), "leaves the folder"));
    CHECK(mentions(errorOf(sceneWith(R"("m": {"type": "ply"})")), "\"filename\" is missing"));
}

TEST_CASE("files: links out of the folder and what is no file are refused") {
    const SceneFolder folder("links_test");
    std::filesystem::create_symlink("/etc/passwd", folder.path / "link.obj");
    std::filesystem::create_symlink("/dev/zero", folder.path / "zero.obj");
    std::filesystem::create_directories(folder.path / "folder.obj");
    const auto error = [&](const std::string& name) {
        return errorOf(sceneWith(R"("m": {"type": "obj", "filename": ")" + name + "\"}"), ExitCode::InvalidConfig, folder.path);
    };
    CHECK(mentions(error("link.obj"), "leaves the folder"));
    CHECK(mentions(error("zero.obj"), "leaves the folder"));
    CHECK(mentions(error("folder.obj"), "no regular file"));
}

TEST_CASE("files: names that no system can follow") {
    const SceneFolder folder("names_test");
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const auto error = [&](const std::string& name) {
        return errorOf(sceneWith(R"("m": {"type": "obj", "filename": ")" + name + "\"}"), ExitCode::InvalidConfig, folder.path);
    };
    CHECK(mentions(error(""), "is empty"));
    CHECK(mentions(error("a.obj\\u0000.png"), "a zero byte"));
    CHECK(mentions(error(std::string(5000, 'a')), "cannot be found"));
    std::filesystem::create_symlink("ring.obj", folder.path / "ring.obj");
    CHECK(mentions(error("ring.obj"), "cannot be found"));
}

TEST_CASE("files: in folders that are allowed") {
    const SceneFolder folder("allowed_test_scene"), other("allowed_test_other"), third("allowed_test_third");
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder.write("own.obj", triangle);
    for (const char* name : {"own.obj", "other.obj"}) other.write(name, triangle);
    third.write("third.obj", triangle);
    std::filesystem::create_directory(other.path / "part.obj");
    std::filesystem::create_symlink(other.path / "other.obj", folder.path / "link.obj");
    std::filesystem::create_symlink(third.path / "third.obj", other.path / "out.obj");
    std::filesystem::create_symlink("/dev/zero", other.path / "zero.obj");
    const auto find = [&](const std::string& name) { return findSceneFile(folder.path, name); };
    const std::string absolute = (other.path / "other.obj").string(), up = "../" + other.path.filename().string() + "/other.obj";
    for (const std::string& name : {absolute, up, std::string("link.obj")}) {
        CHECK(mentions(find(name).refusal, "leaves the folder of the scene"));
        CHECK(mentions(find(name).hint, "--resource-path"));
    }
    CHECK_FALSE(std::filesystem::exists(find("other.obj").path));

    allowFilesFrom(other.path);
    for (const std::string& name : {absolute, up, std::string("link.obj"), std::string("other.obj"), (folder.path / "own.obj").string()}) {
        CHECK(find(name).refusal.empty());
        CHECK(std::filesystem::is_regular_file(find(name).path));
    }
    CHECK(find("own.obj").path == folder.path / "own.obj");
    CHECK(mentions(find("part.obj").refusal, "no regular file"));
    for (const std::string& name : {std::string("out.obj"), std::string("zero.obj"), (third.path / "third.obj").string(), other.path.string() + "x/a.obj"})
        CHECK(mentions(find(name).refusal, "leaves the folder of the scene"));
    CHECK(find("none.obj").refusal.empty());
    CHECK_THROWS_AS(allowFilesFrom(other.path / "none"), Error);
    CHECK_THROWS_AS(allowFilesFrom(other.path / "own.obj"), Error);

    folder.write("scene.xml", R"(<scene version="3.0.0"><include filename="parts/more.xml"/></scene>)");
    std::filesystem::create_directory(other.path / "parts");
    other.write("parts/more.xml", R"(<scene version="3.0.0"><shape type="obj" id="s"><string name="filename" value="near.obj"/></shape></scene>)");
    other.write("parts/near.obj", triangle);
    CHECK(readSceneDocument(folder.path / "scene.xml").json()["s"]["filename"] == "parts/near.obj");
    folder.write("scene.pbrt", "Camera \"perspective\" WorldBegin Include \"shapes.pbrt\"");
    other.write("shapes.pbrt", "Shape \"sphere\"");
    CHECK(readSceneDocument(folder.path / "scene.pbrt").json()["shape"]["type"] == "sphere");
}

TEST_CASE("a scene file holds a scene, not the name of another") {
    const SceneFolder folder("ring_test");
    folder.write("ring.json", "\"ring.json\"");
    CHECK(mentions(errorOf("\"ring.json\"", ExitCode::InvalidConfig, folder.path), "expected a scene"));
}

TEST_CASE("two entries of one name") {
    const std::string message = errorOf(sceneWith(R"("a": {"type": "diffuse", "id": "m"}, "b": {"type": "diffuse", "id": "m"})"));
    CHECK(mentions(message, "another entry is called \"m\""));
    CHECK(mentions(message, "/a"));
}

TEST_CASE("scenes that cannot be rendered") {
    CHECK(mentions(errorOf(R"({"type": "scene"})"), "no sensor"));
    CHECK(mentions(errorOf("{}"), "\"type\""));
    CHECK(mentions(errorOf("[]"), "an object"));
    CHECK(mentions(errorOf(R"({"type": "scene", "sensor": {"type": "perspective"}})"), "no light"));
    CHECK(mentions(
        errorOf(R"({"type": "scene", "sensor": {"type": "perspective"}, "l": {"type": "point", "intensity": 0}})"),
        "no light"));
    CHECK(mentions(errorOf(sceneWith(R"("b": {"type": "perspective"})")), "exactly one sensor"));
    CHECK(mentions(errorOf(sceneWith(R"("a": {"type": "constant"}, "b": {"type": "constant"})")),
                   "at most one environment"));
    CHECK(mentions(errorOf(sceneWith(R"("a": {"type": "area"})")), "nested in a shape"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "e": {"type": "point"}})")), "cannot be nested"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "e": {"type": "area"}, "f": {"type": "area"}})")),
                   "at most one emitter"));
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "e": {"type": "diffuse"}, "f": {"type": "diffuse"}})")),
                   "at most one BSDF"));
}

TEST_CASE("parameters of BSDFs that do not go together") {
    CHECK(mentions(errorOf(sceneWith(R"("b": {"type": "phong", "diffuse_reflectance": 0.7, "specular_reflectance": [0.1, 0.4, 0.1]})")), "add up to 1.1, more than 1"));
    CHECK(mentions(errorOf(sceneWith(R"("b": {"type": "ward", "variant": "duer"})")), "ward-duer"));
    CHECK(mentions(errorOf(sceneWith(R"("b": {"type": "ward", "alpha_u": 0.2})")), "alpha_v is missing"));
    CHECK(mentions(errorOf(sceneWith(R"("b": {"type": "principled", "eta": 1.4, "specular": 0.3})")), "/b/specular"));
    CHECK(mentions(errorOf(sceneWith(R"("b": {"type": "principled", "spec_trans": {"type": "checkerboard"}})")), "/b/spec_trans"));
    CHECK(mentions(errorOf(sceneWith(R"("t": {"type": "twosided", "b": {"type": "principled", "spec_trans": 0.1}})")), "transmits"));
}

TEST_CASE("references and two-sided materials that make no sense") {
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "cube", "b": {"type": "ref", "id": "light"}})")), "no BSDF"));
    CHECK(mentions(errorOf(sceneWith(R"("r": {"type": "ref", "id": "r"})")), "\"ref\""));
    CHECK(mentions(errorOf(sceneWith(R"("t": {"type": "twosided"})")), "one or two"));
    CHECK(mentions(errorOf(sceneWith(R"("t": {"type": "twosided", "b": {"type": "dielectric"}})")), "transmits"));
    CHECK(mentions(errorOf(sceneWith(R"("t": {"type": "twosided", "b": {"type": "ref", "id": "t"}})")),
                   "another twosided"));
}

TEST_CASE("sensors and films that make no sense") {
    const auto sensor = [](const std::string& parameters) {
        return errorOf(R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "perspective", )" +
                       parameters + "}}");
    };
    CHECK(mentions(sensor(R"("fov": 180)"), "/sensor/fov"));
    CHECK(mentions(sensor(R"("fov_axis": "z")"), "/sensor/fov_axis"));
    CHECK(mentions(sensor(R"("focal_length": "50 cm")"), "/sensor/focal_length"));
    CHECK(mentions(sensor(R"("focal_length": "50mm", "fov": 45)"), "not both"));
    CHECK(mentions(sensor(R"("to_world": [{"type": "scale", "value": 2}])"), "must not scale"));
    CHECK(mentions(sensor(R"("film": {"type": "hdrfilm", "width": 0})"), "/sensor/film/width"));
    CHECK(mentions(sensor(R"("film": {"type": "hdrfilm", "width": 10, "crop_offset_x": 5, "crop_width": 6})"),
                   "beyond the film"));
    CHECK(mentions(sensor(R"("film": {"type": "hdrfilm", "rfilter": {"type": "gausian"}})"), "\"gaussian\""));
    CHECK(mentions(sensor(R"("film": {"type": "hdrfilm"}, "other": {"type": "hdrfilm"})"), "one film"));
}

TEST_CASE("integrators and samplers are noted only") {
    const Scene scene =
        loadText(sceneWith(R"("integrator": {"type": "something"}, "x": {"type": "path", "max_depth": 3})"));
    REQUIRE(scene.warnings.size() == 2);
    CHECK(mentions(scene.warnings[0], "no effect"));
}

TEST_CASE("damaged scenes give a scene or an error") {
    const std::string original = sceneWith(
        R"("red": {"type": "diffuse", "reflectance": [0.9, 0.1, 0.2]}, "s": {"type": "sphere", "radius": 2, "bsdf": {"type": "ref", "id": "red"}},
           "m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2]},
           "t": {"type": "cube", "to_world": [{"type": "rotate", "axis": [1,0,0], "angle": 30}], "b": {"type": "twosided", "n": {"type": "conductor"}}})");
    REQUIRE_NOTHROW(loadText(original));
    Random random({9, 10}, 0, 0);
    int errors = 0;
    constexpr int kRounds = 3000;
    for (int i = 0; i < kRounds; ++i) {
        std::string text = original;
        for (int k = random.index(3); k >= 0; --k)
            text[size_t(random.index(int(text.size())))] = char(random.index(256));
        if (random() < 0.2) text.resize(size_t(random.index(int(text.size()))));
        try {
            loadText(text);
        } catch (const Error&) {
            ++errors;
        }
    }
    CHECK(errors > kRounds / 2);
}

TEST_CASE("deep nesting gives an error") {
    const std::string open = R"({"type": "twosided", "n": )";
    std::string deep;
    for (int i = 0; i < 100; ++i) deep += open;
    deep += "1" + std::string(100, '}');
    errorOf(sceneWith("\"t\": " + deep));
    for (int i = 0; i < 10; ++i) deep = "[" + deep + "]";
    errorOf(sceneWith("\"t\": {\"type\": \"cube\", \"to_world\": " + std::string(100000, '[') +
                      std::string(100000, ']') + "}"));
}

TEST_CASE("every plugin has a summary, and its parameters are explained") {
    for (const PluginKind kind : {PluginKind::Shapes, PluginKind::Bsdfs, PluginKind::Emitters, PluginKind::Sensors,
                                  PluginKind::Textures, PluginKind::Films, PluginKind::Filters}) {
        CHECK_FALSE(scenePlugins(kind).empty());
        for (const PluginInfo& plugin : scenePlugins(kind)) {
            CHECK_FALSE(plugin.summary.empty());
            for (const ParameterInfo& parameter : plugin.parameters) CHECK_FALSE(parameter.help.empty());
        }
    }
}

TEST_CASE("the schema knows every plugin and its parameters") {
    const Json schema = sceneSchema();
    CHECK(schema["$schema"] == "http://json-schema.org/draft-07/schema#");
    const std::string text = schema.dump();
    for (const char* name : {"\"sphere\"", "\"radius\"", "\"twosided\"", "\"hdrfilm\"", "\"int_ior\"", "\"ref\""})
        CHECK(mentions(text, name));
}
