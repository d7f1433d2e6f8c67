// Shapes, materials, emitters and sensor as a dictionary describes them, in Mitsuba 3's conventions.

#include "tests/core/scene/load_text.h"

using namespace ulam;

namespace {

struct Seen {
    uint32_t shape;
    Vec3f position, normal, shadingNormal;
};

Seen look(const Scene& scene, const Vec3f& origin, const Vec3f& direction) {
    Hit hit{};
    REQUIRE(scene.rays().intersect(origin, direction, hit));
    Vertex v;
    scene.vertexAt(origin, direction, hit, v);
    return {v.shape, v.position, v.normal, v.shadingNormal};
}

bool near(const Vec3f& a, const Vec3f& b, float tolerance = 1e-5f) {
    return length(a - b) <= tolerance;
}

const Material& materialOf(const Scene& scene, const std::string& id) {
    for (const Shape& shape : scene.shapes)
        if (shape.id == id) return scene.materials[shape.material];
    FAIL("no shape " << id);
    return scene.materials[0];
}

double greyOf(const Coating& coating) {
    return std::get<Diffuse>(coating.bsdf()).reflectance.x;
}

}  // namespace

TEST_CASE("rectangle: the square [-1,1] in x and y with normal +z") {
    const Scene scene = loadText(sceneWith(R"("r": {"type": "rectangle", "emitter": {"type": "area"}})"));
    CHECK(scene.shapes[0].area == Approx(4));
    CHECK(near(look(scene, {0.9f, -0.9f, 5}, {0, 0, -1}).normal, {0, 0, 1}));
    Hit hit{};
    CHECK_FALSE(scene.rays().intersect({1.1f, 0, 5}, {0, 0, -1}, hit));
}

TEST_CASE("rectangle: normals under rotation, mirroring and flip_normals") {
    const auto normal = [](const std::string& extra) {
        return look(loadText(sceneWith(R"("r": {"type": "rectangle", )" + extra + "}")), {0.2f, 0.1f, 5}, {0, 0, -1})
            .normal;
    };
    CHECK(near(normal(R"("flip_normals": true)"), {0, 0, -1}));
    CHECK(near(normal(R"("to_world": [{"type": "rotate", "axis": [1,0,0], "angle": 180}])"), {0, 0, -1}));
    CHECK(near(normal(R"("to_world": [{"type": "scale", "value": [-1,1,1]}])"), {0, 0, 1}));
    CHECK(near(normal(R"("to_world": [{"type": "scale", "value": [1,1,-1]}])"), {0, 0, -1}));
}

TEST_CASE("cube: [-1,1]³ with normals outwards") {
    const Scene scene = loadText(sceneWith(R"("c": {"type": "cube", "emitter": {"type": "area"}})"));
    CHECK(scene.shapes[0].area == Approx(24));
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            Vec3f direction(0.0f), origin(0.3f, 0.2f, 0.1f);
            direction[axis] = -side;
            origin[axis] = 5 * side;
            const Seen seen = look(scene, origin, direction);
            CHECK(near(seen.normal, -direction));
            CHECK(seen.position[axis] == Approx(side));
        }
}

TEST_CASE("sphere: center and radius, then to_world; mirroring turns it inside out") {
    const Scene scene = loadText(sceneWith(
        R"("s": {"type": "sphere", "center": [1,0,0], "radius": 0.5, "to_world": [{"type": "scale", "value": 2}, {"type": "translate", "value": [0,3,0]}]},
           "in": {"type": "sphere", "center": [20,0,0], "flip_normals": true},
           "mirrored": {"type": "sphere", "to_world": [{"type": "scale", "value": [1,1,-1]}, {"type": "translate", "value": [40,0,0]}]})"));
    CHECK(near(std::get<Sphere>(scene.shapes[0].geometry).center, {2, 3, 0}));
    CHECK(std::get<Sphere>(scene.shapes[0].geometry).radius == Approx(1));
    CHECK(near(look(scene, {2, 3, 9}, {0, 0, -1}).normal, {0, 0, 1}));
    CHECK(near(look(scene, {20, 0, 9}, {0, 0, -1}).normal, {0, 0, -1}));
    CHECK(near(look(scene, {40, 0, 9}, {0, 0, -1}).normal, {0, 0, -1}));
}

TEST_CASE("meshes from files: smooth normals unless face_normals, mirroring keeps normals and sides together") {
    const SceneFolder folder("load_test");
    // Two faces that meet at a right angle along the y axis, and the same with normals of their own.
    const std::string roof = "v 0 -1 1\nv 0 1 1\nv 1 1 0\nv 1 -1 0\nv -1 1 0\nv -1 -1 0\n";
    folder.write("roof.obj", roof + "f 1 4 3 2\nf 1 2 5 6\n");
    folder.write("up.obj", roof + "vn 0 0 1\nf 1//1 4//1 3//1 2//1\nf 1//1 2//1 5//1 6//1\n");
    const auto see = [&](const std::string& parameters) {
        return look(loadText(sceneWith(R"("m": {"type": "obj", "filename": )" + parameters + "}"), folder.path),
                    {1e-3f, 0.1f, 9}, {0, 0, -1});
    };
    const Vec3f slope = normalize(Vec3f(1, 0, 1));
    const Seen smooth = see("\"roof.obj\"");
    CHECK(near(smooth.normal, slope));
    CHECK(near(smooth.shadingNormal, {0, 0, 1}, 1e-2f));
    CHECK(near(see(R"("roof.obj", "face_normals": true)").shadingNormal, slope));
    CHECK(near(see(R"("up.obj", "flip_normals": true)").normal, -slope));
    CHECK(near(see(R"("up.obj", "flip_normals": true)").shadingNormal, {0, 0, -1}));
    const Seen mirrored = see(R"("up.obj", "to_world": [{"type": "scale", "value": [1,-1,1]}])");
    CHECK(near(mirrored.normal, slope));
    CHECK(near(mirrored.shadingNormal, {0, 0, 1}));
}

TEST_CASE("degenerate triangles are dropped and counted") {
    const Scene scene = loadText(sceneWith(
        R"("m": {"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0, 2,0,0], "triangles": [0,1,2, 0,1,3, 1,1,1]})"));
    CHECK(std::get<Mesh>(scene.shapes[0].geometry).triangles.size() == 1);
    REQUIRE(scene.warnings.size() == 1);
    CHECK(mentions(scene.warnings[0], "2 degenerate"));
    CHECK(mentions(scene.warnings[0], "/m"));
}

TEST_CASE("materials: defaults, references, two sides") {
    const Scene scene = loadText(sceneWith(
        R"("red": {"type": "diffuse", "reflectance": [0.9, 0.1, 0.2]},
           "plain": {"type": "rectangle"},
           "lamp": {"type": "rectangle", "any name": {"type": "area", "radiance": {"type": "rgb", "value": [1, 2, 3]}}},
           "a": {"type": "sphere", "bsdf": {"type": "ref", "id": "red"}},
           "b": {"type": "sphere", "bsdf": {"type": "ref", "id": "later"}},
           "c": {"type": "cube", "x": {"type": "twosided", "y": {"type": "ref", "id": "red"}}},
           "d": {"type": "cube", "x": {"type": "twosided", "y": {"type": "conductor"}, "z": {"type": "diffuse", "reflectance": 0.25}}},
           "any": {"type": "dielectric", "id": "later", "int_ior": "diamond", "ext_ior": 1.25})"));
    CHECK(greyOf(materialOf(scene, "plain").front) == 0.5);
    CHECK_FALSE(materialOf(scene, "plain").back);
    CHECK(greyOf(materialOf(scene, "lamp").front) == 0);
    CHECK(&materialOf(scene, "a") == &scene.materials[scene.shapes[2].material]);
    CHECK(greyOf(materialOf(scene, "a").front) == 0.9);
    CHECK(std::get<Dielectric>(materialOf(scene, "b").front.bsdf()).ior == Approx(2.419 / 1.25));
    CHECK(greyOf(*materialOf(scene, "c").back) == 0.9);
    CHECK(std::holds_alternative<Conductor>(materialOf(scene, "d").front.bsdf()));
    CHECK(greyOf(*materialOf(scene, "d").back) == 0.25);
    const auto& lamp = std::get<AreaEmitter>(scene.emitters[scene.shapes[1].emitter]);
    CHECK(lamp.shape == 1);
    CHECK(lamp.emitted == Spectrum(1, 2, 3));
}

TEST_CASE("dielectric: the defaults are glass in air") {
    const Scene scene = loadText(sceneWith(R"("s": {"type": "sphere", "bsdf": {"type": "dielectric"}})"));
    CHECK(std::get<Dielectric>(materialOf(scene, "s").front.bsdf()).ior == Approx(1.5046 / 1.000277));
}

TEST_CASE("emitters: point and constant") {
    const Scene scene = loadText(R"({"type": "scene", "sensor": {"type": "perspective"},
        "p": {"type": "point", "position": [1,2,3], "intensity": 4},
        "q": {"type": "point", "to_world": [{"type": "translate", "value": [5,6,7]}]},
        "sky": {"type": "constant", "radiance": [0.1, 0.2, 0.3]}})");
    CHECK(near(std::get<PointEmitter>(scene.emitters[0]).position, {1, 2, 3}));
    CHECK(std::get<PointEmitter>(scene.emitters[0]).intensity == Spectrum(4.0));
    CHECK(near(std::get<PointEmitter>(scene.emitters[1]).position, {5, 6, 7}));
    CHECK(scene.environment == 2);
}

TEST_CASE("film: defaults, crop, filter, and what replaces it") {
    const std::string text = sceneWith("");
    const FilmSize plain = describeText(text).filmSize();
    CHECK(plain.width == 768);
    CHECK(plain.height == 576);
    CHECK(plain.cropWidth == 768);
    CHECK(loadText(text).filter.type() == ReconstructionFilter::Type::Gaussian);

    const std::string cropped = R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "perspective",
        "film": {"type": "hdrfilm", "width": 100, "height": 50, "crop_offset_x": 10, "crop_width": 20, "crop_offset_y": 5,
        "rfilter": {"type": "tent", "radius": 2}, "pixel_format": "rgb", "widht": 3}, "sampler": {"type": "independent", "sample_count": 16}}})";
    const FilmSize crop = describeText(cropped).filmSize();
    CHECK(crop.cropOffsetX == 10);
    CHECK(crop.cropWidth == 20);
    CHECK(crop.cropHeight == 45);
    const Scene scene = loadText(cropped);
    CHECK(scene.sensor->width() == 20);
    CHECK(scene.filter.radius() == 2);
    CHECK(scene.sensor->window().min == Vec2f(-1.5f, -1.5f));
    REQUIRE(scene.warnings.size() == 3);
    CHECK(mentions(scene.warnings[0] + scene.warnings[1] + scene.warnings[2], "did you mean \"width\""));

    const FilmSize replaced = describeText(cropped).filmSize({{"width", 64}, {"crop_width", 0}});
    CHECK(replaced.width == 64);
    CHECK(replaced.cropWidth == 54);
    CHECK_THROWS_AS(describeText(cropped).filmSize({{"height", 5}}), Error);
}

TEST_CASE("the camera looks along +z, its image has +x on the left and +y up") {
    const Scene scene =
        loadText(R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "perspective", "fov": 90,
        "film": {"type": "hdrfilm", "width": 100, "height": 100, "rfilter": {"type": "box"}}}})");
    CHECK(near(scene.sensor->direction(scene.sensor->samplePosition({}), {50, 50}), {0, 0, 1}));
    CHECK(near(scene.sensor->direction(scene.sensor->samplePosition({}), {0, 50}), normalize(Vec3f(1, 0, 1))));
    CHECK(near(scene.sensor->direction(scene.sensor->samplePosition({}), {50, 0}), normalize(Vec3f(0, 1, 1))));
}

TEST_CASE("without fov the field of view is that of a 50 mm lens on 35 mm film, along the diagonal") {
    const auto corner = [](const std::string& parameters) {
        const Scene scene = loadText(R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "perspective", )" +
                                     parameters + R"("film": {"type": "hdrfilm", "width": 36, "height": 24}}})");
        return double(scene.sensor->direction(scene.sensor->samplePosition({}), {0, 0}).z);
    };
    CHECK(std::abs(corner("") - 50 / std::hypot(50, 18, 12)) < 1e-6);
    CHECK(std::abs(corner(R"("focal_length": "35mm", )") - 35 / std::hypot(35, 18, 12)) < 1e-6);
}

TEST_CASE("vertex normals say which side of a mesh is its front, whatever the winding") {
    for (const char* triangle : {"[0, 1, 2]", "[0, 2, 1]"})
        for (const char* placement : {"1", "[-1, 1, 1]"}) {
            const Scene scene = loadText(sceneWith(fmt::format(
                R"("m": {{"type": "mesh", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": {}, "normals": [0,0,1, 0,0,1, 0,0,1]}},
                   "s": {{"type": "rectangle", "to_world": [{{"type": "scale", "value": {}}}]}})",
                triangle, placement)));
            for (const Shape& shape : scene.shapes) {
                Vertex v{};
                v.uv = {0.2f, 0.3f};
                shape.setNormals(v);
                CHECK(near(v.normal, {0, 0, 1}));
            }
        }
}

TEST_CASE("the hash changes with the dictionary, the film and the files") {
    const SceneFolder folder("hash_test");
    const std::string text = sceneWith(R"("m": {"type": "obj", "filename": "a.obj"})");
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string hash = loadText(text, folder.path).hash;
    CHECK(hash.size() == 64);
    CHECK(hash == loadText(text, folder.path).hash);
    CHECK(hash != describeText(text, folder.path).build({{"width", 10}}).hash);
    CHECK(hash !=
          loadText(sceneWith(R"("m": {"type": "obj", "filename": "a.obj", "face_normals": true})"), folder.path).hash);
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    CHECK(hash != loadText(text, folder.path).hash);
}

TEST_CASE("a scene file is found relative to the folder, and its meshes relative to itself") {
    const SceneFolder folder("file_test");
    std::filesystem::create_directories(folder.path / "inner");
    folder.write("inner/a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    folder.write("inner/scene.json", sceneWith(R"("m": {"type": "ply", "filename": "a.ply"})"));
    const JsonNode name(Json("inner/scene.json"));
    CHECK(SceneDescription::fromNode(name, folder.path).build().shapes.size() == 1);
    CHECK(SceneDescription::fromFile(folder.path / "inner/scene.json").generator() == nullptr);
}

TEST_CASE("roughdiffuse, phong, ward and principled: their parameters, with Mitsuba's defaults") {
    const Scene scene = loadText(sceneWith(R"(
        "a": {"type": "cube", "bsdf": {"type": "roughdiffuse", "use_fast_approx": true}},
        "b": {"type": "cube", "bsdf": {"type": "phong"}},
        "c": {"type": "cube", "bsdf": {"type": "phong", "exponent": {"type": "checkerboard", "color0": 10, "color1": 1000}}},
        "d": {"type": "cube", "bsdf": {"type": "ward"}},
        "e": {"type": "cube", "bsdf": {"type": "ward", "variant": "ward", "alpha_u": 0.3, "alpha_v": 0.2}},
        "f": {"type": "cube", "bsdf": {"type": "twosided", "b": {"type": "principled", "specular": 0}}},
        "g": {"type": "cube", "bsdf": {"type": "principled", "eta": 1.3, "spec_trans": 1, "main_specular_sampling_rate": 2}}
    )"));
    const auto bsdfOf = [&]<class B>(const std::string& id, B*) { return std::get<B>(materialOf(scene, id).front.bsdf()); };
    const auto clay = bsdfOf("a", (RoughDiffuse*)nullptr);
    CHECK(clay.qualitative);
    CHECK(clay.alpha == 0.2);
    CHECK(clay.reflectance == Spectrum(0.5));
    const auto paint = bsdfOf("b", (Phong*)nullptr);
    CHECK(paint.exponent == 30);
    CHECK(paint.diffuseReflectance == Spectrum(0.5));
    CHECK(paint.specularReflectance == Spectrum(0.2));
    CHECK(std::get<TexturedBsdf>(materialOf(scene, "c").front.layer).bindings.size() == 1);
    CHECK(bsdfOf("d", (Ward*)nullptr).variant == Ward::Variant::Balanced);
    CHECK(bsdfOf("d", (Ward*)nullptr).alphaV == 0.1);
    CHECK(bsdfOf("e", (Ward*)nullptr).variant == Ward::Variant::Ward);
    CHECK(bsdfOf("e", (Ward*)nullptr).alphaU == 0.3);
    CHECK(bsdfOf("e", (Ward*)nullptr).alphaV == 0.2);
    CHECK(bsdfOf("f", (Principled*)nullptr).ior == 1);
    CHECK(bsdfOf("f", (Principled*)nullptr).roughness == 0.5);
    CHECK(bsdfOf("g", (Principled*)nullptr).ior == 1.3);
    CHECK(bsdfOf("g", (Principled*)nullptr).transmits);
}
