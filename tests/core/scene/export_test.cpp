#include <pugixml.hpp>

#include "core/base/file.h"
#include "core/scene/export/mitsuba.h"
#include "core/scene/mesh_io.h"
#include "tests/support/error_of.h"
#include "tests/core/scene/load_text.h"
#include "core/render/driver.h"
#include "tests/support/path_scenes.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

/// An exported scene and its XML.
struct Exported {
    SceneFolder files{"export_test"};
    fs::path folder = files.path / "out";
    std::vector<std::string> leftOut;
    pugi::xml_document xml;

    explicit Exported(const std::string& text) {
        files.write("triangle.ply", kTrianglePly);
        leftOut = exportMitsuba3(describeText(text, files.path), folder);
        REQUIRE(xml.load_file((folder / "scene.xml").c_str()));
    }

    pugi::xml_node find(const std::string& xpath) const {
        const auto found = xml.select_nodes(("/scene/" + xpath).c_str());
        INFO(xpath);
        REQUIRE(found.size() == 1);
        return found.first().node();
    }
    std::string value(const std::string& xpath) const { return find(xpath).attribute("value").value(); }
};

/// Everything below a folder, with the bytes of its files.
std::map<std::string, std::string> contentOf(const fs::path& folder) {
    std::map<std::string, std::string> content;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        content[entry.path().lexically_relative(folder)] = entry.is_regular_file() ? readFile(entry.path()) : "";
    return content;
}

}  // namespace

TEST_CASE("export: every kind of parameter becomes Mitsuba's element for it") {
    const Exported e(sceneWith(R"(
        "ball": {"type": "sphere", "center": [1, 2.5, -3], "radius": 0.30000000000000004, "flip_normals": true,
                 "to_world": [{"type": "scale", "value": 2}, {"type": "translate", "value": [1, 2, 3]}],
                 "bsdf": {"type": "dielectric", "int_ior": "bk7", "ext_ior": 1.25, "specular_reflectance": 0.75}},
        "sun": {"type": "directional", "direction": [0, -1, 0]},
        "lamp": {"type": "spot", "cutoff_angle": 20, "beam_width": 0},
        "tiles": {"type": "disk", "bsdf": {"type": "mask", "bsdf": {"type": "diffuse"}, "opacity":
                  {"type": "checkerboard", "color0": 1, "to_uv": [{"type": "scale", "value": 4}]}}},
        "wall": {"type": "rectangle",
                 "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [1e-7, 2, 1e22]}}}
    )"));
    CHECK(e.leftOut.empty());
    CHECK(std::string(e.find(".").attribute("version").value()) == "3.0.0");
    CHECK(e.value("shape[@type='sphere' and @id='ball']/point[@name='center']") == "1, 2.5, -3");
    CHECK(e.value("shape/float[@name='radius']") == "0.30000000000000004");
    CHECK(e.value("shape/boolean[@name='flip_normals']") == "true");
    CHECK(e.value("shape/transform[@name='to_world']/matrix") == "2 0 0 1 0 2 0 2 0 0 2 3 0 0 0 1");
    CHECK(e.value("shape/bsdf[@type='dielectric']/string[@name='int_ior']") == "bk7");
    CHECK(e.value("shape/bsdf/float[@name='ext_ior']") == "1.25");
    CHECK(e.value("shape/bsdf/rgb[@name='specular_reflectance']") == "0.75, 0.75, 0.75");
    CHECK(e.value("shape[@type='rectangle' and @id='wall']/emitter[@type='area']/rgb") == "1e-07, 2, 1e+22");
    CHECK(std::string(e.find("emitter[@type='point']").attribute("id").value()) == "light");
    CHECK(e.value("emitter[@type='directional']/vector[@name='direction']") == "0, -1, 0");
    CHECK(e.value("emitter[@type='spot']/float[@name='cutoff_angle']") == "20");
    CHECK(e.xml.select_nodes("//float[@name='beam_width']").empty());
    CHECK(e.value("shape[@id='tiles']/bsdf[@type='mask']/texture[@type='checkerboard' and @name='opacity']/rgb") == "1, 1, 1");
    CHECK(e.value("shape[@id='tiles']//transform[@name='to_uv']/matrix") == "4 0 0 0 0 4 0 0 0 0 4 0 0 0 0 1");
}

TEST_CASE("export: references keep their targets, ids become plain and stay different") {
    const Exported e(sceneWith(R"(
        "a b": {"type": "diffuse", "reflectance": 0.1}, "a.b": {"type": "diffuse", "reflectance": 0.2},
        "_": {"type": "diffuse", "id": "own", "reflectance": 0.3},
        "two": {"type": "twosided", "z": {"type": "ref", "id": "a.b"}, "a": {"type": "ref", "id": "own"}},
        "wall": {"type": "rectangle", "bsdf": {"type": "ref", "id": "a b"}}
    )"));
    const auto reflectanceOf = [&](const pugi::xml_node& reference) {
        return e.value(fmt::format("bsdf[@id='{}']/rgb", reference.attribute("id").value()));
    };
    CHECK(reflectanceOf(e.find("shape/ref")) == "0.1, 0.1, 0.1");
    CHECK(reflectanceOf(e.find("bsdf/ref[1]")) == "0.2, 0.2, 0.2");
    CHECK(reflectanceOf(e.find("bsdf/ref[2]")) == "0.3, 0.3, 0.3");
    for (const auto& plugin : e.find(".").children())
        CHECK(std::string(plugin.attribute("id").value()).find_first_of(" ._") != 0);
}

TEST_CASE("export: inline meshes become files, files are copied") {
    const Exported e(sceneWith(R"(
        "flat": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0, 5,5,5], "triangles": [0,1,2, 0,1,1],
                 "bsdf": {"type": "diffuse"}},
        "smooth": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,2,1],
                   "normals": [0,0,1,0,0,1,0,0,1]},
        "one": {"type": "ply", "filename": "triangle.ply"},
        "two": {"type": "ply", "filename": "triangle.ply", "face_normals": true}
    )"));
    const auto meshOf = [&](const std::string& id) {
        const std::string file = e.value(fmt::format("shape[@type='ply' and @id='{}']/string[@name='filename']", id));
        return readPly(readFile(e.folder / file), file);
    };
    const Mesh flat = meshOf("flat"), smooth = meshOf("smooth");
    CHECK(flat.triangles.size() == 1);
    CHECK(flat.positions.size() == 4);
    CHECK(flat.normals.empty());
    CHECK(e.value("shape[@id='flat']/boolean[@name='face_normals']") == "true");
    CHECK(smooth.normals.size() == 3);
    CHECK(smooth.triangles[0] == std::array<uint32_t, 3>{0, 1, 2});
    CHECK(e.xml.select_nodes("/scene/shape[@id='smooth']/boolean").empty());
    e.find("shape[@id='flat']/bsdf");
    const std::string copy = e.value("shape[@id='one']/string");
    CHECK(e.value("shape[@id='two']/string") == copy);
    CHECK(readFile(e.folder / copy) == kTrianglePly);
    CHECK(!fs::is_symlink(e.folder / copy));
}

TEST_CASE("export: the sensor's defaults that Mitsuba does not share") {
    const Exported e(R"({"type": "scene", "light": {"type": "point"},
        "ball": {"type": "sphere", "center": [0, 0, 2e5]},
        "camera": {"type": "perspective", "fov": 0, "near_clip": 1,
                   "to_world": [{"type": "translate", "value": [0, 0, 1]}],
                   "film": {"type": "hdrfilm", "width": 40, "height": 30, "crop_offset_x": 8,
                            "rfilter": {"type": "tent", "radius": 2}}}})");
    CHECK(e.xml.select_nodes("//float[@name='fov']").empty());
    CHECK(std::stod(e.value("sensor/float[@name='far_clip']")) > 2e5);
    CHECK(std::stod(e.value("sensor/float[@name='near_clip']")) < 1);
    CHECK(e.value("sensor/film/integer[@name='width']") == "40");
    CHECK(e.value("sensor/film/integer[@name='crop_width']") == "32");
    CHECK(e.value("sensor/film/integer[@name='crop_height']") == "30");
    CHECK(e.value("sensor/film/rfilter[@type='tent']/float") == "2");
}

TEST_CASE("export: what has no meaning here is named, not dropped") {
    const Exported e(R"({"type": "scene", "light": {"type": "point"}, "integrator": {"type": "path", "max_depth": 8},
        "sensor": {"type": "perspective", "sampler": {"type": "independent"},
                   "film": {"type": "hdrfilm", "pixel_format": "rgb"}}})");
    REQUIRE(e.leftOut.size() == 3);
    CHECK(e.leftOut[0] == R"("path" at /integrator)");
    CHECK(e.leftOut[1] == R"("sampler" of "perspective" at /sensor/sampler)");
    CHECK(e.leftOut[2] == R"("pixel_format" of "hdrfilm" at /sensor/film/pixel_format)");
}

TEST_CASE("export: Mitsuba 3 is told not to turn normals, nor to attenuate light at the horizon") {
    const Exported e(sceneWith(R"("a": {"type": "cube", "bsdf": {"type": "bumpmap", "h": {"type": "checkerboard"}, "x": {"type": "diffuse"}}})"));
    for (const char* name : {"flip_invalid_normals", "use_shadowing_function"})
        CHECK(e.value(fmt::format("shape[@id='a']/bsdf[@type='bumpmap']/boolean[@name='{}']", name)) == "false");
}

TEST_CASE("export: what Mitsuba 3 lacks is written as the nearest, and named") {
    const Exported e(sceneWith(R"(
        "clay": {"type": "roughdiffuse", "reflectance": 0.3, "alpha": 0.5},
        "a": {"type": "cube", "bsdf": {"type": "phong", "exponent": 198, "diffuse_reflectance": [0.1, 0.2, 0.3]}},
        "b": {"type": "cube", "bsdf": {"type": "twosided", "x": {"type": "ward", "alpha_u": 0.4, "alpha_v": 0.1, "specular_reflectance": 0.04}}},
        "c": {"type": "cube", "bsdf": {"type": "principled", "metallic": 0.25, "eta": 1.25}},
        "d": {"type": "cube", "bsdf": {"type": "ref", "id": "clay"}}
    )"));
    REQUIRE(e.leftOut.size() == 3);
    CHECK(e.leftOut[0] == R"("roughdiffuse", written as "diffuse", at /clay)");
    CHECK(e.leftOut[1] == R"("phong", written as "principled", at /a/bsdf)");
    CHECK(e.leftOut[2] == R"("ward", written as "principled", at /b/bsdf/x)");
    CHECK(e.value("bsdf[@type='diffuse' and @id='clay']/rgb[@name='reflectance']") == "0.3, 0.3, 0.3");
    CHECK(e.value("shape[@id='a']/bsdf[@type='principled']/rgb[@name='base_color']") == "0.1, 0.2, 0.3");
    CHECK(std::stod(e.value("shape[@id='a']/bsdf/float[@name='roughness']")) == Approx(std::sqrt(0.1)));
    const std::string gloss = "shape[@id='b']/bsdf/bsdf[@type='principled']/float";
    CHECK(std::stod(e.value(gloss + "[@name='eta']")) == Approx(1.5));
    CHECK(std::stod(e.value(gloss + "[@name='roughness']")) == Approx(std::sqrt(0.2)));
    CHECK(std::stod(e.value(gloss + "[@name='anisotropic']")) == Approx(0.75 / 0.9));
    CHECK(e.value("shape[@id='c']/bsdf[@type='principled']/float[@name='metallic']") == "0.25");
    CHECK(e.value("shape[@id='c']/bsdf/float[@name='eta']") == "1.25");
}

TEST_CASE("export: an earlier export is replaced, other people's files are not") {
    const SceneFolder files("export_folder");
    const fs::path folder = files.path / "deep" / "out";
    const auto exportWith = [&](const std::string& entries) {
        return errorOf([&] { exportMitsuba3(describeText(sceneWith(entries)), folder); });
    };
    const std::string mesh = R"({"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2]})";
    REQUIRE(exportWith("\"old\": " + mesh).code == ExitCode::Done);
    REQUIRE(exportWith("\"new\": " + mesh).code == ExitCode::Done);
    const auto exported = contentOf(folder);
    CHECK(exported.size() == 3);
    CHECK(exported.contains("meshes/new.ply"));

    SECTION("a scene that cannot be loaded leaves it alone") {
        CHECK(exportWith(R"("bad": {"type": "ply", "filename": "missing.ply"})").code == ExitCode::InputMissing);
        CHECK(contentOf(folder) == exported);
    }
    SECTION("a file that no export wrote stays") {
        for (const char* name : {"image.exr", "meshes/mine.ply"}) {
            writeFileAtomically(folder / name, "mine");
            const Complaint complaint = exportWith("\"new\": " + mesh);
            CHECK(complaint.code == ExitCode::CannotWrite);
            CHECK(complaint.has(name));
            CHECK(readFile(folder / name) == "mine");
            fs::remove(folder / name);
        }
    }
    SECTION("a scene by somebody else stays") {
        writeFileAtomically(folder / "scene.xml", R"(<scene><string value="meshes/new.ply"/></scene>)");
        CHECK(exportWith("").code == ExitCode::CannotWrite);
    }
    SECTION("so does a file of that name") {
        fs::remove_all(folder);
        writeFileAtomically(folder, "mine");
        CHECK(exportWith("").code == ExitCode::CannotWrite);
        CHECK(readFile(folder) == "mine");
    }
    SECTION("an empty folder and a link to one are filled") {
        fs::remove_all(folder);
        fs::create_directory(files.path / "real");
        fs::create_directory_symlink(files.path / "real", folder);
        CHECK(exportWith("").code == ExitCode::Done);
        CHECK(fs::is_symlink(folder));
        CHECK(fs::exists(files.path / "real" / "scene.xml"));
    }
    CHECK(std::distance(fs::directory_iterator(folder.parent_path()), {}) == 1);  // nothing temporary is left
}

TEST_CASE("export: groups and instances, inline meshes in groups as files, the same bytes again from what was written") {
    const std::string text = sceneWith(R"(
        "tree": {"type": "shapegroup", "ball": {"type": "sphere", "radius": 0.5, "bsdf": {"type": "ref", "id": "grey"}},
                 "leaf": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2], "bsdf": {"type": "diffuse", "reflectance": 0.25}}},
        "grey": {"type": "diffuse", "reflectance": 0.3},
        "one": {"type": "instance", "of": {"type": "ref", "id": "tree"}, "to_world": [{"type": "translate", "value": [1,2,3]}]},
        "two": {"type": "instance", "of": {"type": "shapegroup", "box": {"type": "cube"}}, "to_world": [{"type": "scale", "value": [1,-2,1]}]}
    )");
    const Exported e(text);
    CHECK(e.leftOut.empty());
    CHECK(e.value("shape[@type='shapegroup' and @id='tree']/shape[@type='sphere']/float") == "0.5");
    const std::string file = e.value("shape[@id='tree']/shape[@type='ply']/string[@name='filename']");
    CHECK(readPly(readFile(e.folder / file), file).triangles.size() == 1);
    e.find("shape[@id='tree']/shape[@type='ply']/bsdf");
    CHECK(std::string(e.find("shape[@type='instance' and @id='one']/ref").attribute("id").value()) == "tree");
    CHECK(e.value("shape[@id='one']/transform/matrix") == "1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1");
    const std::string apart = e.find("shape[@id='two']/ref").attribute("id").value();
    e.find(fmt::format("shape[@type='shapegroup' and @id='{}']/shape[@type='cube']", apart));

    // Read and written again: the same, but that the copy of a file is named after its folder too.
    const fs::path again = e.files.path / "again";
    exportMitsuba3(SceneDescription::fromFile(e.folder / "scene.xml"), again);
    CHECK(readFile(again / "meshes/meshes_leaf.ply") == readFile(e.folder / file));
    std::string xml = readFile(again / "scene.xml");
    const std::string line = "      <string name=\"filename\" value=\"meshes/meshes_leaf.ply\" />\n";
    REQUIRE(xml.find(line) != std::string::npos);
    xml.erase(xml.find(line), line.size());
    std::string written = readFile(e.folder / "scene.xml");
    const std::string original = "      <string name=\"filename\" value=\"meshes/leaf.ply\" />\n";
    REQUIRE(written.find(original) != std::string::npos);
    written.erase(written.find(original), original.size());
    CHECK(xml == written);
    const Scene first = describeText(text, e.files.path).build(), second = SceneDescription::fromFile(again / "scene.xml").build();
    REQUIRE(second.shapes.size() == first.shapes.size());
    for (size_t i = 0; i < first.shapes.size(); ++i) {
        const auto* placed = std::get_if<MeshInstance>(&first.shapes[i].geometry);
        if (!placed) continue;
        CHECK(std::get<MeshInstance>(second.shapes[i].geometry).toWorld == placed->toWorld);
        CHECK(std::get<MeshInstance>(second.shapes[i].geometry).mesh->positions == placed->mesh->positions);
    }
}

TEST_CASE("export: read back, a scene gives the same image to the last bit") {
    const auto imageOf = [](const SceneDescription& description) {
        const Json film = {{"width", 24}, {"height", 18}, {"crop_offset_x", 0}, {"crop_offset_y", 0}, {"crop_width", 24}, {"crop_height", 18}};
        const auto sampler = Registry<Sampler>::instance().create(JsonNode(Json{{"type", "bdpt"}, {"max_depth", 6}}));
        RenderOptions options;
        options.budget.spp = 4;
        options.threads = 2;
        options.key = makeKey(5);
        return render(description.build(film), *sampler, options).image;
    };
    const SceneFolder files("round_trip");
    for (const PathScene& named : pathScenes()) {
        const SceneDescription description = describeScene(named.dictionary);
        const Image original = imageOf(description);
        for (const auto& [version, write] : {std::pair{std::string("3"), &exportMitsuba3}, {"0.6", &exportMitsuba06}}) {
            INFO(named.name << " for Mitsuba " << version);
            const std::vector<std::string> leftOut = write(description, files.path / "out");
            CAPTURE(leftOut);
            const Image again = imageOf(SceneDescription::fromFile(files.path / "out" / "scene.xml"));
            fs::remove_all(files.path / "out");
            // Mitsuba 3 has no coats, and the sun of 0.6 is another than this one, into which it is read back.
            const bool coats = named.name == "layers" && version == "3", sun = named.name == "clear_sky" && version == "0.6";
            CHECK(leftOut.empty() == !(coats || sun));
            if (coats) continue;
            REQUIRE(again.pixels.size() == original.pixels.size());
            CHECK(std::memcmp(again.pixels.data(), original.pixels.data(), again.pixels.size() * sizeof(Rgb)) == 0);
        }
    }
}
