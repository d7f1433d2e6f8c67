// Masks, mixtures and reliefs over BSDFs of every kind: definitions, densities, lobes, inverses, and normals in closed
// form.

#include "core/image/image_io.h"
#include "core/path/local_bsdf.h"
#include "core/path/reference_factors.h"
#include "core/path/scattering.h"
#include "tests/core/scene/bsdf_examples.h"
#include "tests/core/scene/load_text.h"
#include "tests/support/chi_square.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

const std::array kLobes{Lobe::Smooth, Lobe::DeltaReflection, Lobe::DeltaTransmission, Lobe::Null};

Coating plain(const Bsdf& bsdf) {
    return {TexturedBsdf{bsdf, {}}};
}
Coating masked(const Bsdf& bsdf, double opacity) {
    return {Mixture{{plain(Null(Null::Parameters())), plain(bsdf)}, {{1 - opacity}, {opacity}}}};
}

/// A place in a scene, to look at coatings there.
struct Place {
    Scene scene = buildScene(pathScene("layers").dictionary);
    Vertex vertex{};
    Place() {
        vertex.kind = Vertex::Kind::Surface;
        vertex.normal = normalize(Vec3f(0.3f, 0.8f, -0.2f));
        vertex.shadingNormal = normalize(vertex.normal + Vec3f(0.1f, 0, 0.15f));
        for (uint32_t i = 0; i < scene.shapes.size(); ++i)
            if (scene.shapes[i].id == "floor") vertex.shape = i;
        vertex.uv = {0.3f, 0.2f};
    }
    template <class Function>
    decltype(auto) look(const Coating& coating, Function&& function) const {
        return withCoating(scene, vertex, coating, function);
    }
    Relief relief(Relief::Kind kind, const Coating& nested) const {
        Relief relief{kind, 0, 0.15, {nested}};
        // The scene's textures hold numbers from 0 to 1; normals.exr has blue above 0.5 everywhere.
        for (uint32_t i = 0; i < scene.textures.size(); ++i) {
            const auto* bitmap = std::get_if<BitmapTexture>(&scene.textures[i]);
            if (bitmap && (bitmap->smallest().z > 0.5f) == (kind == Relief::Kind::Normals)) relief.texture = i;
        }
        return relief;
    }
};

Coating varnished(const Coating& nested, std::optional<double> alpha = {}) {
    Varnish varnish{1.5, {0.1, 0.3, 0}, {1, 0.9, 0.8}, nullptr, {nested}};
    if (alpha) {
        const MicrofacetDistribution distribution{MicrofacetDistribution::Kind::Beckmann, *alpha, *alpha};
        varnish.rough =
            std::make_shared<RoughCoat>(RoughCoat{distribution, RoughTransmittance(distribution, varnish.ior)});
    }
    return {varnish};
}

std::vector<Coating> layerExamples(const Place& place) {
    const Coating glass = plain(dielectric(1.5)), coat = plain(plastic(1.5, 0.8)), wall = plain(diffuse(0.7));
    const Coating metal = plain(roughConductor(0.2, 3.9, "beckmann", 0.3, 0.2)), mirror = plain(conductor(0.2, 3.9));
    const Coating holes = masked(thinDielectric(1.5), 0.6), twice = {Mixture{{glass, coat}, {{0.3}, {0.7}}}};
    using Kind = Relief::Kind;
    return {
        holes,
        twice,
        {Mixture{{metal, mirror, wall}, {{0.3}, {0.4}, {0.2}}}},
        {Mixture{{twice, masked(diffuse(0.4), 0.5), metal}, {{0.5}, {0.2}, {0.3}}}},
        {place.relief(Kind::Heights, coat)},
        {place.relief(Kind::Normals, glass)},
        {place.relief(Kind::Normals, twice)},
        {Mixture{{Coating{place.relief(Kind::Heights, metal)}, Coating{place.relief(Kind::Normals, mirror)}},
                 {{0.6}, {0.4}}}},
        {place.relief(Kind::Heights, Coating{place.relief(Kind::Normals, metal)})},
        varnished(wall),
        varnished(mirror),
        varnished(Coating{Mixture{{mirror, wall}, {{0.4}, {0.6}}}}),
        varnished(metal, 0.2),
        varnished(Coating{Mixture{{mirror, wall}, {{0.4}, {0.6}}}}, 0.1),
    };
}

}  // namespace

TEST_CASE("a mask lets through what it does not cover, and the nested BSDF has the rest") {
    Random random(makeKey(50), 0, 0);
    const Place place;
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& nested) {
            for (const double opacity : {0.0, 0.3, 1.0})
                place.look(masked(any, opacity), [&](const auto& mask) {
                    INFO("BSDF " << any.index() << ", opacity " << opacity);
                    CHECK(mask.albedo() == Approx(1 - opacity + opacity * nested.albedo()));
                    for (int i = 0; i < 200; ++i) {
                        const Vec3d a(onSphere(random)), b(i % 2 ? Vec3d(onSphere(random)) : -a);
                        for (const Lobe lobe : kLobes) {
                            const Spectrum f = mask.eval(a, b, lobe), inner = nested.eval(a, b, lobe) * opacity;
                            const double straight = lobe == Lobe::Null && a.z * b.z < 0 ? 1 - opacity : 0;
                            for (int c = 0; c < 3; ++c) REQUIRE(f[c] == Approx(inner[c] + straight));
                            REQUIRE(mask.pdf(a, b, lobe) ==
                                    Approx(nested.pdf(a, b, lobe) * opacity + straight * std::abs(b.z)));
                        }
                    }
                });
        });
}

TEST_CASE("light through a mask over a pane is one lobe") {
    const Place place;
    const ThinDielectric pane = thinDielectric(1.5);
    const Vec3d w(0.6, 0, 0.8), back = -w;
    const double through = pane.probability(w, back, Lobe::Null);
    place.look(masked(pane, 0.25), [&](const auto& mask) {
        CHECK(mask.probability(w, back, Lobe::Null) == Approx(0.75 + 0.25 * through));
        CHECK(mask.eval(w, back, Lobe::Null).x == Approx(0.75 + 0.25 * through));
        CHECK(mask.pdf(w, back, Lobe::Null) == Approx((0.75 + 0.25 * through) * 0.8));
        CHECK(mask.probability(w, reflected(w), Lobe::DeltaReflection) == Approx(0.25 * (1 - through)));
    });
    const auto inverts = [&](const Bsdf& bsdf, double opacity, const Vec3f& to, Lobe lobe) {
        Block u{};
        return place.look(masked(bsdf, opacity),
                          [&](const auto& mask) { return mask.invert(Vec3f(0, 0, 1), to, lobe, u); });
    };
    CHECK_FALSE(inverts(diffuse(0.5), 1, {0, 0, -1}, Lobe::Null));
    CHECK_FALSE(inverts(diffuse(0.5), 0, {0, 0, 1}, Lobe::Smooth));
    CHECK(inverts(diffuse(0.5), 0.5, {0, 0, -1}, Lobe::Null));
}

TEST_CASE("layers choose lobes with their probabilities, the smooth one with the upper end of its number") {
    Random random(makeKey(51), 0, 0);
    const Place place;
    std::vector<Coating> coatings = layerExamples(place);
    for (const Bsdf& any : bsdfs()) coatings.push_back(masked(any, 0.65));
    for (size_t which = 0; which < coatings.size(); ++which)
        place.look(coatings[which], [&](const auto& layer) {
            for (const double z : {0.8, -0.4}) {
                const Vec3f from = directionOf(0.2, z);
                INFO("coating " << which << ", cosine " << z);
                const double smooth = smoothShareOf(layer, from);
                std::array<double, 4> counts{}, probabilities{};
                // A plain probability differs between directions of a lobe only where two parts send it different ways.
                const int samples = 20'000;
                double found = 0;
                for (int i = 0; i < samples; ++i) {
                    const Block numbers = random.nextBlock();
                    const auto s = layer.sample(from, numbers);
                    if (!s) continue;
                    ++found;
                    ++counts[size_t(s->lobe)];
                    probabilities[size_t(s->lobe)] = layer.probability(Vec3d(from), Vec3d(s->to), s->lobe);
                    REQUIRE((s->lobe == Lobe::Smooth) == (numbers[2] >= 1 - smooth));
                    if (!(layer.pdf(Vec3d(from), Vec3d(s->to), s->lobe) > 0)) continue;
                    Block u = random.nextBlock();
                    REQUIRE(layer.invert(from, s->to, s->lobe, u));
                    for (const double number : u) REQUIRE((number >= 0 && number <= 1));
                    const auto again = layer.sample(from, u);
                    REQUIRE(again);
                    REQUIRE(again->lobe == s->lobe);
                    // Refraction out of a coat spreads directions along the surface by 1/cosθ.
                    REQUIRE(length(again->to - s->to) < 1e-5f * std::max(1.0f, 0.3f / std::abs(s->to.z)));
                }
                if (found == samples) {
                    CHECK_FIT(misfit(counts, probabilities));
                    CHECK(smooth == Approx(probabilities[0]));
                }
            }
        });
}

TEST_CASE("smooth lobes of layers follow their density") {
    const Place place;
    const std::vector<Coating> coatings = layerExamples(place);
    uint64_t seed = 900;
    int tested = 0;
    for (size_t which = 0; which < coatings.size(); ++which)
        place.look(coatings[which], [&](const auto& layer) {
            const Vec3f from = directionOf(0.7, 0.6);
            ++seed;
            if (!(smoothShareOf(layer, from) > 0)) return;
            INFO("coating " << which);
            ++tested;
            CHECK_FIT(misfit(
                kDirections,
                [&](Random& r) -> std::optional<Sample2> {
                    const auto s = layer.sample(from, r.nextBlock());
                    return s && s->lobe == Lobe::Smooth ? std::optional(azimuthAndZ(s->to)) : std::nullopt;
                },
                [&](double phi, double z) { return layer.pdf(Vec3d(from), Vec3d(directionOf(phi, z)), Lobe::Smooth); },
                seed));
            // A lobe by itself has the density that its probability leaves.
            const double share = smoothShareOf(layer, from);
            CHECK_FIT(misfit(
                kDirections,
                [&](Random& r) -> std::optional<Sample2> {
                    const auto s = layer.sampleLobe(from, Lobe::Smooth, r.nextBlock());
                    return s ? std::optional(azimuthAndZ(s->to)) : std::nullopt;
                },
                [&](double phi, double z) {
                    return layer.pdf(Vec3d(from), Vec3d(directionOf(phi, z)), Lobe::Smooth) / share;
                },
                seed + 100));
        });
    CHECK(tested == 11);
}

TEST_CASE("random numbers of an inverse through layers have the law of the numbers that made the direction") {
    const Place place;
    const Vec3f above = directionOf(1, 0.9), below = directionOf(1, -0.95);
    const Coating pane = masked(thinDielectric(2.4), 0.7), coat = masked(roughPlastic(1.5, 0.8, "beckmann", 0.2), 0.4);
    const Coating both{Mixture{{pane, plain(dielectric(1))}, {{0.4}, {0.6}}}},
        three{Mixture{{plain(plastic(1.5, 0.6)), plain(diffuse(0.4)), coat}, {{0.3}, {0.5}, {0.2}}}};
    uint64_t seed = 1200;
    const auto check = [&](const Coating& coating, const Vec3f& from) {
        place.look(coating, [&](const auto& layer) { checkNumbersOfInverse(layer, from, seed); });
        seed += 2;
    };
    check(pane, above);
    check(pane, below);
    check(coat, above);
    check(both, below);
    check(three, above);
    check({place.relief(Relief::Kind::Normals, three)}, above);
    check(varnished(Coating{Mixture{{plain(conductor(0.2, 3.9)), plain(conductor(0, 1))}, {{0.4}, {0.6}}}}), above);
}

TEST_CASE("layers agree with a second writing of their definitions") {
    Random random(makeKey(53), 0, 0);
    Place place;
    Material& material = place.scene.materials[place.scene.shapes[place.vertex.shape].material];
    const std::vector<Coating> examples = layerExamples(place);
    for (size_t which = 0; which < examples.size(); ++which) {
        material = Material(examples[which]);
        int compared = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3f toLight = onSphere(random);
            Vertex v = place.vertex;
            ScatteredDirection s;
            if (!sampleScattering(place.scene, v, toLight, From::Light, random.nextBlock(), s)) continue;
            const Scattering found = scatter(place.scene, v, v.lobe, toLight, s.direction);
            const FactorRanges ranges = scatteringReference(place.scene, v, inDouble(toLight), inDouble(s.direction));
            const double values[] = {found.f.x, found.f.y, found.f.z, found.pdfToCamera, found.pdfToLight};
            for (size_t j = 0; j < 5; ++j) {
                INFO("coating " << which << ", lobe " << int(v.lobe) << ", factor " << j << ": " << values[j] << " in ["
                                << ranges[j].low << ", " << ranges[j].high << "]");
                const double slack = 1e-6 * std::abs(ranges[j].high) + 1e-12;
                REQUIRE(values[j] >= ranges[j].low - slack);
                REQUIRE(values[j] <= ranges[j].high + slack);
            }
            CHECK(deltaLawError(place.scene, v, inDouble(toLight), inDouble(s.direction)) < 1e-5);
            ++compared;
        }
        CHECK(compared > 500);
    }
}

TEST_CASE(
    "a coat gives back no more than it receives, and a clear one over white nothing but what is reflected inside") {
    const Place place;
    Diffuse::Parameters white;
    white.reflectance = Spectrum(1.0);
    for (const std::optional<double> alpha : {std::optional<double>{}, std::optional(0.3)})
        place.look(varnished(plain(Diffuse(white)), alpha), [&](const auto& layer) {
            for (const double z : {1.0, 0.6, 0.2}) {
                const Vec3d from(directionOf(0.3, z));
                Spectrum sum =
                    overSphere([&](const Vec3d& to) { return layer.eval(from, to, Lobe::Smooth) * std::abs(to.z); });
                sum += layer.eval(from, reflected(from), Lobe::DeltaReflection);
                CHECK(maxComponent(sum) <= layer.albedo());
                if (alpha) continue;
                // Blue is not absorbed: F s + (1 − F) (1 − R_i), of diffuse light inside.
                const double f = fresnelFromThinSide(z, 1.5);
                CHECK(sum.z == Approx(0.8 * f + (1 - f) * (1 - diffuseFresnelFromInside(1.5))).epsilon(1e-3));
            }
        });
}

TEST_CASE("a relief is the nested BSDF around the other normal") {
    Random random(makeKey(52), 0, 0);
    Place place;
    Material& material = place.scene.materials[place.scene.shapes[place.vertex.shape].material];
    int compared = 0;
    for (const Bsdf& nested : bsdfs()) {
        if (dispatch(nested, [](const auto& bsdf) {
                return requires {
                    bsdf.anisotropic();
                };
            }))
            continue;
        for (const auto kind : {Relief::Kind::Heights, Relief::Kind::Normals}) {
            const Relief relief = place.relief(kind, plain(nested));
            const Shape& shape = place.scene.shapes[place.vertex.shape];
            const Frame base(place.vertex.shadingNormal, shape.tangent(place.vertex));
            // Where the frame takes the third axis.
            const ReliefAt at(place.scene, place.vertex, relief);
            const Vec3f n(at.turned(Vec3f(1, 0, 0)).z, at.turned(Vec3f(0, 1, 0)).z, at.turned(Vec3f(0, 0, 1)).z);
            CHECK(n.z < 0.9999f);
            Vertex other = place.vertex;
            other.shadingNormal = base.toWorld(n);
            for (int i = 0; i < 200; ++i) {
                const Vec3f toLight = onSphere(random);
                material = Material(plain(nested));
                ScatteredDirection s;
                if (!sampleScattering(place.scene, other, toLight, From::Light, random.nextBlock(), s)) continue;
                const Scattering expected = scatter(place.scene, other, other.lobe, toLight, s.direction);
                material = Material(Coating{relief});
                const Scattering found = scatter(place.scene, place.vertex, other.lobe, toLight, s.direction);
                if (dot(toLight, place.vertex.shadingNormal) * dot(toLight, other.shadingNormal) <= 0) {
                    CHECK(isBlack(found.f));
                    continue;
                }
                for (int c = 0; c < 3; ++c) REQUIRE(found.f[c] == Approx(expected.f[c]).epsilon(2e-3));
                REQUIRE(found.pdfToCamera == Approx(expected.pdfToCamera).epsilon(2e-3));
                REQUIRE(found.pdfToLight == Approx(expected.pdfToLight).epsilon(2e-3));
                ++compared;
            }
        }
    }
    CHECK(compared > 2'000);
}

TEST_CASE("normals of height fields and of pictures, in closed form") {
    const SceneFolder folder("layers_test");
    // A ramp of 4 texels whose height grows by 0.1 a texel, over a rectangle two units wide and six high; and a normal.
    Image ramp(4, 4), normal(1, 1, Rgb(0.8f, 0.6f, 0.9f));
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) ramp.at(x, y) = Rgb(0.1f * float(x));
    writeExr((folder.path / "ramp.exr").string(), ramp);
    writeExr((folder.path / "normal.exr").string(), normal);
    const auto normalOf = [&](const std::string& bsdf, const Vec3f& at, float side) {
        const Scene scene = loadText(
            sceneWith(R"("r": {"type": "rectangle", "to_world": [{"type": "scale", "value": [1, 3, 1]}], "b": )" +
                      bsdf + "}"),
            folder.path);
        Hit hit{};
        Vertex v{};
        REQUIRE(scene.rays().intersect(at + Vec3f(0, 0, 5 * side), {0, 0, -side}, hit));
        scene.vertexAt(at + Vec3f(0, 0, 5 * side), {0, 0, -side}, hit, v);
        // A mirror's directions tell its normal.
        ScatteredDirection s;
        REQUIRE(sampleScattering(scene, v, Vec3f(0, 0, side), From::Camera, Block{}, s));
        return normalize(s.direction + Vec3f(0, 0, side));
    };
    const std::string mirror = R"({"type": "conductor"})";
    const std::string bump =
        R"({"type": "bumpmap", "scale": 2, "h": {"type": "bitmap", "filename": "ramp.exr", "wrap_mode": "clamp"}, "b": )" +
        mirror + "}";
    // Height 2 × 0.1 a texel of 0.5 units: slope 0.4 along x.
    const auto near = [](const Vec3f& a, const Vec3f& b) { return length(a - normalize(b)) < 1e-5f; };
    CHECK(near(normalOf(bump, {0.2f, 1, 0}, 1), {-0.4f, 0, 1}));
    // On the back of a two-sided surface heights stand out too, as in Mitsuba.
    const std::string twosided = R"({"type": "twosided", "b": )" + bump + "}";
    CHECK(near(normalOf(twosided, {0.2f, 1, 0}, 1), {-0.4f, 0, 1}));
    CHECK(near(normalOf(twosided, {0.2f, 1, 0}, -1), {-0.4f, 0, -1}));
    const std::string map =
        R"({"type": "normalmap", "normalmap": {"type": "bitmap", "filename": "normal.exr", "raw": true}, "b": )" +
        mirror + "}";
    CHECK(near(normalOf(map, {0.2f, 1, 0}, 1), {0.6f, 0.2f, 0.8f}));
}

TEST_CASE("compositions that cannot be are refused, with place and reason") {
    const SceneFolder folder("layers_errors_test");
    writeExr((folder.path / "h.exr").string(), Image(2, 2, Rgb(0.5f)));
    const auto refused = [&](const std::string& bsdf, const std::string& reason) {
        const std::string message = errorOf(sceneWith(R"("r": {"type": "rectangle", "b": )" + bsdf + "}"),
                                            ExitCode::InvalidConfig, folder.path);
        INFO(bsdf << "\n" << message);
        CHECK(message.find(reason) != std::string::npos);
    };
    const std::string bumped =
        R"({"type": "bumpmap", "h": {"type": "bitmap", "filename": "h.exr"}, "b": {"type": "conductor"}})";
    refused(R"({"type": "blendbsdf", "a": {"type": "twosided", "x": {"type": "diffuse"}}, "b": {"type": "diffuse"}})",
            "some are twosided");
    refused(R"({"type": "blendbsdf", "a": {"type": "diffuse"}})", "blendbsdf needs two BSDFs, not 1");
    refused(R"({"type": "blendbsdf", "weight": 1.5, "a": {"type": "diffuse"}, "b": {"type": "diffuse"}})", "weight");
    refused(R"({"type": "mixturebsdf", "weights": [0.6, 0.6], "a": {"type": "diffuse"}, "b": {"type": "diffuse"}})",
            "add up to 1.2");
    refused(R"({"type": "mixturebsdf", "a": {"type": "diffuse"}})", "weights");
    refused(R"({"type": "mixturebsdf", "weights": [0.5], "a": {"type": "diffuse"}, "b": {"type": "diffuse"}})", "2");
    refused(R"({"type": "blendbsdf", "a": {"type": "dielectric"}, "b": {"type": "dielectric", "int_ior": 1.2}})",
            "different indices");
    refused(R"({"type": "blendbsdf", "a": {"type": "conductor"}, "b": )" + bumped + "}",
            "under different bump or normal maps");
    refused(R"({"type": "bumpmap", "b": {"type": "conductor"}})", "needs a texture");
    refused(R"({"type": "bumpmap", "use_shadowing_function": true, "h": {"type": "checkerboard"}, "b": {"type": "diffuse"}})",
            "not supported");
    refused(R"({"type": "bumpmap", "h": {"type": "bitmap", "filename": "h.exr"}})", "needs one BSDF, not 0");
    refused(R"({"type": "normalmap", "b": {"type": "conductor"}})", "normalmap");
    refused(R"({"type": "coating", "b": {"type": "dielectric"}})", "must not transmit");
    refused(R"({"type": "coating", "int_ior": 1, "b": {"type": "diffuse"}})", "higher index");
    refused(R"({"type": "roughcoating", "alpha": 0, "b": {"type": "diffuse"}})", "alpha");
    refused(R"({"type": "twosided", "b": {"type": "mask", "b": {"type": "diffuse"}}})", "transmits");
    // A ring of references.
    CHECK(
        errorOf(
            sceneWith(
                R"("a": {"type": "mask", "b": {"type": "ref", "id": "c"}}, "c": {"type": "mask", "b": {"type": "ref", "id": "a"}})"))
            .find("nested deeper than") != std::string::npos);
}
