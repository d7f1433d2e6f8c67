// Scenes exported to pbrt-v4 and read back: the same images, and a line for all that pbrt lacks.

#include "core/base/file.h"
#include "core/image/image_io.h"
#include "core/render/driver.h"
#include "core/scene/export/mitsuba.h"
#include "core/scene/export/pbrt4.h"
#include "experiments/statistics/holm.h"
#include "experiments/statistics/welch.h"
#include "tests/core/scene/pbrt_scene.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

/// An exported scene, with its text and what was left out of it.
struct ExportedPbrt {
    SceneFolder files{"pbrt4_export"};
    fs::path folder = files.path / "out";
    std::vector<std::string> leftOut;

    ExportedPbrt() {
        Image sky(512, 257);
        for (int j = 0; j < 257; ++j)
            for (int i = 0; i < 512; ++i)
                sky.at(i, j) = {float(1 + std::sin(2 * kPi * i / 512) * std::sin(kPi * j / 256)),
                                float(1 + std::cos(kPi * j / 256)), 0.3f};
        writeExr((files.path / "sky.exr").string(), sky);
        Image square(32, 32, Rgb(0.5f));
        square.at(20, 12) = Rgb(40, 30, 20);
        writeExr((files.path / "square.exr").string(), square);
        Image picture(4, 4);
        for (int i = 0; i < 16; ++i)
            picture.pixels[size_t(i)] = {0.05f * float(i), 0.9f - 0.05f * float(i), i % 3 == 0 ? 0.8f : 0.2f};
        writeExr((files.path / "picture.exr").string(), picture);
    }
    SceneDescription describe(const std::string& text) const { return describeText(text, files.path); }
    SceneDescription roundTrip(const SceneDescription& description) {
        leftOut = exportPbrt4(description, folder);
        return SceneDescription::fromFile(folder / "scene.pbrt");
    }
    std::string text() const { return readFile(folder / "scene.pbrt"); }
};

constexpr int kRuns = 8, kTile = 8;
constexpr double kLevel = 1e-4;  // of a false alarm a pair of scenes

/// Means of tiles and channels, run by run.
std::vector<std::vector<double>> tileMeans(const Scene& scene, uint64_t seed) {
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(Json{{"type", "path"}, {"max_depth", 5}}));
    std::vector<std::vector<double>> result;
    for (int run = 0; run < kRuns; ++run) {
        RenderOptions options;
        options.budget.spp = 64;
        options.threads = 2;
        options.key = makeKey(seed, 0, uint64_t(run));
        const Image image = render(scene, *sampler, options).image;
        const int across = image.width / kTile, down = image.height / kTile;
        std::vector<double> means(size_t(3 * across * down));
        for (int y = 0; y < down * kTile; ++y)
            for (int x = 0; x < across * kTile; ++x)
                for (int c = 0; c < 3; ++c)
                    means[size_t(3 * (y / kTile * across + x / kTile) + c)] += image.at(x, y)[c] / (kTile * kTile);
        result.resize(means.size());
        for (size_t i = 0; i < means.size(); ++i) result[i].push_back(means[i]);
    }
    return result;
}

/// The smallest p of Welch's tests of all tiles and channels, after Holm. Means that differ by less than single
/// precision and the resampling of environments make are equal.
double smallestP(const SceneDescription& a, const SceneDescription& b, const Json& film = {}) {
    constexpr double kResampling = 1e-3;
    const auto first = tileMeans(a.build(film), 11), second = tileMeans(b.build(film), 12);
    REQUIRE(first.size() == second.size());
    std::vector<double> p;
    for (size_t i = 0; i < first.size(); ++i) {
        const auto x = statistics::estimateMean(first[i]), y = statistics::estimateMean(second[i]);
        p.push_back(std::abs(x.mean - y.mean) <= kResampling * std::abs(x.mean) ? 1 : statistics::welchTest(x, y).p);
    }
    const auto adjusted = statistics::holmAdjusted(p);
    return *std::min_element(adjusted.begin(), adjusted.end());
}

const std::string kFilm = R"("film": {"type": "hdrfilm", "width": 48, "height": 32, "rfilter": {"type": "box"}})";

const std::string kTextures = R"({"type": "scene",
    "sensor": {"type": "thinlens", "fov": 50, "aperture_radius": 0.05, "focus_distance": 5,
               "to_world": [{"type": "lookat", "origin": [1, 2, 5], "target": [0, 0.7, 0], "up": [0, 1, 0]}], )" +
                              kFilm + R"(},
    "sky": {"type": "envmap", "filename": "sky.exr", "scale": 0.7, "to_world": [{"type": "rotate", "axis": [1, 2, 0], "angle": 70}]},
    "picture": {"type": "bitmap", "filename": "picture.exr", "to_uv": [{"type": "scale", "value": [2, 3, 1]}, {"type": "translate", "value": [0.25, 0.1, 0]}]},
    "floor": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}],
              "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "ref", "id": "picture"}}}},
    "ball": {"type": "sphere", "center": [-1, 1, 0], "to_world": [{"type": "rotate", "axis": [1, 0, 1], "angle": 50}],
             "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "ref", "id": "picture"}}}},
    "tin": {"type": "cylinder", "p0": [1.2, 0, 0], "p1": [1.2, 1.5, 0], "radius": 0.5, "bsdf": {"type": "mask", "opacity":
            {"type": "checkerboard", "color0": 1, "color1": 0, "to_uv": [{"type": "scale", "value": [3, 2, 1]}]},
            "bsdf": {"type": "twosided", "bsdf": {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.2}}}}})";

const std::string kLights = R"({"type": "scene",
    "sensor": {"type": "perspective", "fov": 60, "principal_point_offset_x": 0.1, "principal_point_offset_y": -0.05,
               "to_world": [{"type": "lookat", "origin": [0, 3, 6], "target": [0, 0.5, 0], "up": [0, 1, 0]}],
               "film": {"type": "hdrfilm", "width": 64, "height": 40, "crop_offset_x": 8, "crop_offset_y": 4, "crop_width": 48, "crop_height": 32,
                        "rfilter": {"type": "tent", "radius": 1.25}}},
    "spot": {"type": "spot", "cutoff_angle": 35, "beam_width": 20, "intensity": [30, 20, 10],
             "to_world": [{"type": "lookat", "origin": [-2, 4, 1], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "point": {"type": "point", "position": [2, 3, 2], "intensity": [2, 4, 8]},
    "sun": {"type": "directional", "direction": [1, -2, -1], "irradiance": [0.5, 0.6, 0.7]},
    "floor": {"type": "disk", "to_world": [{"type": "scale", "value": 4}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}],
              "bsdf": {"type": "twosided", "bsdf": {"type": "roughplastic", "distribution": "ggx", "alpha": 0.3, "nonlinear": true,
                                                    "diffuse_reflectance": [0.2, 0.5, 0.7]}}},
    "block": {"type": "cube", "to_world": [{"type": "scale", "value": [0.5, -0.7, 0.4]}, {"type": "rotate", "axis": [0, 1, 0], "angle": 30}, {"type": "translate", "value": [-1, 0.7, 0]}],
              "bsdf": {"type": "twosided", "bsdf": {"type": "roughconductor", "eta": [1, 1.5, 2], "k": [3, 2, 1], "distribution": "ggx", "alpha_u": 0.3, "alpha_v": 0.15}}},
    "glass": {"type": "sphere", "center": [1, 0.8, 0], "radius": 0.7, "bsdf": {"type": "roughdielectric", "int_ior": 1.4, "distribution": "ggx", "alpha": 0.25}}})";

const std::string kAreas = R"({"type": "scene",
    "sensor": {"type": "perspective", "fov": 40, "fov_axis": "y",
               "to_world": [{"type": "lookat", "origin": [0, 1, 5], "target": [0, 0.8, 0], "up": [0.2, 1, 0]}], )" +
                           kFilm + R"(},
    "air": {"type": "constant", "radiance": [0.1, 0.2, 0.3]},
    "shell": {"type": "sphere", "radius": 8, "flip_normals": true, "emitter": {"type": "area", "radiance": 0.2}},
    "lamp": {"type": "disk", "to_world": [{"type": "scale", "value": [0.5, -0.8, 1]}, {"type": "rotate", "axis": [1, 0, 0], "angle": 100}, {"type": "translate", "value": [0, 2.5, 0]}],
             "emitter": {"type": "area", "radiance": [9, 8, 7]}},
    "tube": {"type": "cylinder", "p0": [-2, 0.2, 0], "p1": [-1.5, 2, 0.5], "radius": 0.1, "emitter": {"type": "area", "radiance": [2, 5, 2]}},
    "panel": {"type": "mesh", "positions": [1,0,-1, 2.5,0,0, 2.5,2,0, 1,2,-1], "triangles": [0,1,2,0,2,3], "emitter": {"type": "area", "radiance": [1, 0.5, 3]}},
    "floor": {"type": "rectangle", "to_world": [{"type": "scale", "value": [3, 3, -1]}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}],
              "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.6}}},
    "pane": {"type": "rectangle", "to_world": [{"type": "translate", "value": [0, 0.8, 1.5]}], "bsdf": {"type": "thindielectric", "int_ior": 1.6}}})";

}  // namespace

TEST_CASE("pbrt-v4 export: a scene that is read back looks the same") {
    ExportedPbrt e;
    SECTION("the Cornell box, and one with a lamp 5 % brighter does not") {
        const auto box = [&](double lamp) {
            return SceneDescription::fromNode(JsonNode(Json{{"type", "cornell_box"}, {"radiance", lamp}}),
                                              e.files.path);
        };
        const Json film = {{"width", 32}, {"height", 32}};
        const SceneDescription back = e.roundTrip(box(10));
        CHECK(smallestP(box(10), back, film) > kLevel);
        CHECK(smallestP(box(10.5), back, film) < kLevel);
        CHECK(e.leftOut == std::vector<std::string>{"black backs of 4 BSDFs, which reflect on both sides in pbrt"});
    }
    SECTION("an environment, textures and a lens") {
        CHECK(smallestP(e.describe(kTextures), e.roundTrip(e.describe(kTextures))) > kLevel);
    }
    SECTION("a spot, a point, a sun, rough materials and a cropped film") {
        CHECK(smallestP(e.describe(kLights), e.roundTrip(e.describe(kLights))) > kLevel);
    }
    SECTION("shapes that shine from one side") {
        CHECK(smallestP(e.describe(kAreas), e.roundTrip(e.describe(kAreas))) > kLevel);
    }
}

TEST_CASE("pbrt-v4 export: what pbrt lacks is named") {
    ExportedPbrt e;
    const SceneDescription description = e.describe(R"({"type": "scene", "integrator": {"type": "path"},
        "sensor": {"type": "perspective", "sampler": {"type": "independent"}, "film": {"type": "hdrfilm", "pixel_format": "rgb"}},
        "lamp": {"type": "spot", "cutoff_angle": 20},
        "clay": {"type": "twosided", "x": {"type": "roughdiffuse", "reflectance": 0.3, "alpha": 0.5}},
        "a": {"type": "cube", "bsdf": {"type": "ref", "id": "clay"}},
        "b": {"type": "cube", "bsdf": {"type": "twosided", "x": {"type": "plastic"}, "y": {"type": "diffuse"}}},
        "c": {"type": "cube", "bsdf": {"type": "dielectric", "specular_transmittance": 0.5}},
        "d": {"type": "cube", "bsdf": {"type": "twosided", "x": {"type": "phong", "exponent": 198}}},
        "e": {"type": "cube", "bsdf": {"type": "twosided", "x": {"type": "principled", "metallic": 1, "roughness": 0.5}}},
        "f": {"type": "sphere", "bsdf": {"type": "twosided", "x": {"type": "roughconductor", "material": "Au"}}},
        "g": {"type": "disk", "bsdf": {"type": "twosided", "x": {"type": "diffuse", "reflectance": {"type": "checkerboard"}}}},
        "h": {"type": "sphere", "emitter": {"type": "area", "radiance": {"type": "bitmap", "filename": "picture.exr"}}}})");
    const Scene back = e.roundTrip(description).build();
    std::string all;
    for (const std::string& line : e.leftOut) all += line + "\n";
    for (const char* line :
         {"\"path\" at /integrator", "\"independent\" at /sensor/sampler",
          "\"pixel_format\" of \"hdrfilm\" at /sensor/film/pixel_format",
          "the linear edge of \"spot\", written as a smooth one, at /lamp",
          "\"roughdiffuse\", written as \"diffuse\", at /clay/x",
          "\"plastic\", written as \"coateddiffuse\", at /b/bsdf/x", "the back of \"twosided\" at /b/bsdf/y",
          "\"specular_transmittance\" of \"dielectric\" at /c/bsdf/specular_transmittance",
          "\"phong\", written as \"roughplastic\", at /d/bsdf/x",
          "\"principled\", written as \"roughconductor\", at /e/bsdf/x",
          "Beckmann's distribution of \"roughconductor\", written as GGX, at /f/bsdf/x",
          "texture coordinates that are turned against the surface's at /g/bsdf/x/reflectance",
          "the texture of \"radiance\", written as its mean, at /h"}) {
        INFO(all);
        INFO(line);
        CHECK(mentions(all, line));
    }
    CHECK(back.shapes.size() == 8);
    CHECK(mentions(e.text(), "\"spectrum eta\" \"metal-Au-eta\""));
    // Pictures and meshes are in the folder, and nothing else is.
    CHECK(fs::exists(e.folder / "meshes" / "a.ply"));
    // An earlier export is replaced, one for another renderer is not.
    CHECK(errorOf([&] { exportPbrt4(description, e.folder); }).message.empty());
    CHECK(errorOf([&] { exportMitsuba3(description, e.folder); }).code == ExitCode::CannotWrite);
}

TEST_CASE("Mitsuba 3 export: octahedral environments and scaled pictures are made ones that Mitsuba has") {
    ExportedPbrt e;
    const auto description = e.describe(R"({"type": "scene", "sensor": {"type": "perspective"},
        "sky": {"type": "envmap", "filename": "square.exr", "mapping": "octahedral", "scale": 2},
        "wall": {"type": "rectangle", "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "filename": "picture.exr", "scale": 0.5, "invert": true}}}})");
    exportMitsuba3(description, e.folder);
    const std::string xml = readFile(e.folder / "scene.xml");
    CHECK(!mentions(xml, "octahedral"));
    CHECK(!mentions(xml, "invert"));
    const Image sky = readImage((e.folder / "textures" / "environment.exr").string()),
                picture = readImage((e.folder / "textures" / "picture.exr").string());
    CHECK(sky.width == 64);
    CHECK(picture.pixels[2].x == Approx(1 - 0.5 * 0.1));
    const Scene before = description.build(), after = SceneDescription::fromFile(e.folder / "scene.xml").build();
    CHECK(std::get<EnvmapEmitter>(after.emitters[0]).map->totalLuminance() ==
          Approx(std::get<EnvmapEmitter>(before.emitters[0]).map->totalLuminance()));
}
