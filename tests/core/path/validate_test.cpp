// The validator accepts what bidirectional path tracing makes and finds planted damage.

#include "core/path/validate.h"

#include "tests/core/path/random_paths.h"
#include "tests/support/error_of.h"

using namespace ulam;

TEST_CASE("the validator accepts every path of bidirectional path tracing") {
    for (const PathScene& named : pathScenes()) {
        INFO(named.name);
        const Scene scene = buildScene(named.dictionary);
        BidirectionalSampler sampler = samplerFor(scene);
        Tracing tracing(scene);
        int accepted = 0, lost = 0;
        forEachPath(sampler, 16, 10'000, [&](const Contribution& c, const Path& path, int) {
            PathFactors factors;
            if (!evaluate(scene, path, factors)) {
                ++lost;
                return;
            }
            const auto wrong = validate(tracing, kTestLimits, path, factors);
            INFO("technique (" << c.technique.s << ", " << c.technique.t << "): " << wrong.value_or(""));
            REQUIRE_FALSE(wrong);
            ++accepted;
        });
        CHECK(accepted > 5'000);
        // Directions that graze a shading normal within rounding.
        CHECK(lost <= 1e-4 * accepted);
    }
}

namespace {

/// A path of a scene for which `wanted` holds, with its factors.
struct Specimen {
    const Scene scene;
    Tracing tracing{scene};
    Path path;
    PathFactors factors;

    template <class Wanted>
    Specimen(const std::string& name, Wanted&& wanted) : scene(buildScene(pathScene(name).dictionary)) {
        BidirectionalSampler sampler = samplerFor(scene);
        forEachPath(sampler, 17, 20'000, [&](const Contribution&, const Path& p, int) {
            if (path.size() == 0 && wanted(p) && evaluate(scene, p, factors)) path = p;
        });
        REQUIRE(path.size() > 0);
        REQUIRE_FALSE(validate(tracing, kTestLimits, path, factors));
    }

    std::string finding(const PathLimits& limits = kTestLimits) {
        return validate(tracing, limits, path, factors).value_or("nothing");
    }
    /// Recomputes the factors of the damaged path as the renderer would.
    void reevaluate() { evaluate(scene, path, factors); }
};

/// Index of a vertex with this lobe, or 0.
int find(const Path& path, Lobe lobe) {
    for (int i = 1; i < path.length(); ++i)
        if (path[i].lobe == lobe) return i;
    return 0;
}

bool smoothPath(const Path& path) {
    return path.size() == 5 && !find(path, Lobe::DeltaReflection) && !find(path, Lobe::DeltaTransmission);
}

}  // namespace

#define CHECK_FINDING(specimen, part)                   \
    do {                                                \
        const std::string found = (specimen).finding(); \
        INFO(found);                                    \
        CHECK(mentions(found, part));                   \
    } while (false)

TEST_CASE("the validator finds damage of a path") {
    Specimen x("diffuse", smoothPath);
    SECTION("length") {
        CHECK(mentions(x.finding({3, 2}), "max_depth"));
        x.factors.size = 3;
        CHECK_FINDING(x, "factors of 3");
        x.path.resize(1);
        CHECK_FINDING(x, "1 vertices");
    }
    SECTION("a moved vertex") {
        x.path[2].position += x.path[2].normal * 1e-3f;
        x.reevaluate();
        CHECK_FINDING(x, "x_2 of x_0 … x_4: at");
    }
    SECTION("a vertex moved within its surface") {
        const Vertex& v = x.path[2];
        x.path[2].position += Frame(v.normal).s * 1e-3f;
        x.reevaluate();
        CHECK_FINDING(x, "x_2 of x_0 … x_4: at");
    }
    SECTION("a wrong normal") {
        x.path[2].normal = Frame(x.path[2].normal).s;
        CHECK_FINDING(x, "normal");
    }
    SECTION("a wrong shading normal") {
        x.path[2].shadingNormal = normalize(x.path[2].normal + Frame(x.path[2].normal).s * 0.01f);
        x.reevaluate();
        CHECK_FINDING(x, "shading normal");
    }
    SECTION("a turned normal") {
        x.path[2].normal = -x.path[2].normal;
        CHECK_FINDING(x, "normal");
    }
    SECTION("another shape") {
        x.path[2].shape = (x.path[2].shape + 1) % uint32_t(x.scene.shapes.size());
        CHECK_FINDING(x, "x_2");
        x.path[2].shape = 77;
        CHECK_FINDING(x, "shape 77");
    }
    SECTION("a kind") {
        x.path[2].kind = Vertex::Kind::Infinite;
        CHECK_FINDING(x, "at infinity, expected a surface");
    }
    SECTION("a delta lobe on a diffuse surface") {
        x.path[2].lobe = Lobe::DeltaReflection;
        CHECK_FINDING(x, "has no lobe delta reflection");
    }
    SECTION("a lobe at an end") {
        x.path[0].lobe = Lobe::DeltaReflection;
        CHECK_FINDING(x, "an end of the path");
    }
    SECTION("a start that does not shine") {
        x.path[0] = x.path[1];
        CHECK_FINDING(x, "x_0");
    }
    SECTION("a lens elsewhere") {
        x.path[4].position.x += 1e-3f;
        CHECK_FINDING(x, "the pinhole is at");
    }
    SECTION("an occluded edge") {
        // x_2 in the place of a vertex of another path that x_1 faces but does not see.
        BidirectionalSampler sampler = samplerFor(x.scene);
        bool planted = false;
        forEachPath(sampler, 18, 2'000, [&](const Contribution&, const Path& other, int) {
            const Vertex& v = other[other.length() - 1];
            if (planted || !v.onSurface() || Edge(x.path[1], v).geometry() < 0.01 || x.tracing.visible(x.path[1], v))
                return;
            x.path[2] = v;
            x.path[2].lobe = Lobe::Smooth;
            planted = true;
        });
        REQUIRE(planted);
        x.reevaluate();
        CHECK_FINDING(x, "something stands between");
    }
}

TEST_CASE("the validator finds damage of delta vertices") {
    Specimen mirror("glass_and_mirror",
                    [](const Path& p) { return find(p, Lobe::DeltaReflection) && !find(p, Lobe::DeltaTransmission); });
    Specimen glass("glass_and_mirror", [](const Path& p) { return find(p, Lobe::DeltaTransmission) > 0; });
    const int r = find(mirror.path, Lobe::DeltaReflection), t = find(glass.path, Lobe::DeltaTransmission);
    SECTION("taken for smooth") {
        mirror.path[r].lobe = Lobe::Smooth;
        CHECK_FINDING(mirror, "has no lobe smooth");
    }
    SECTION("taken for the other lobe") {
        glass.path[t].lobe = Lobe::DeltaReflection;
        CHECK_FINDING(glass, "misses its law");
        mirror.path[r].lobe = Lobe::DeltaTransmission;
        CHECK_FINDING(mirror, "misses its law");
    }
    SECTION("a neighbour moved on its surface: the law fails") {
        for (Specimen* x : {&mirror, &glass}) {
            const int i = x == &mirror ? r : t;
            const Vec3f w = directionTo(x->path[i], x->path[i - 1]);
            REQUIRE(x->tracing.next(x->path[i], normalize(w + Frame(w).s * 0.01f), x->path[i - 1]));
            x->reevaluate();
            CHECK(mentions(x->finding(), "misses its law"));
        }
    }
}

TEST_CASE("the validator finds damage of factors") {
    Specimen x("glass_and_mirror",
               [](const Path& p) { return find(p, Lobe::DeltaTransmission) && find(p, Lobe::Smooth); });
    const int t = find(x.path, Lobe::DeltaTransmission), k = x.path.length();
    const PathFactors sound = x.factors;
    const auto damage = [&](double& number, const std::string& part) {
        for (const double factor : {1.001, -1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
            const double old = number;
            number *= factor;
            CHECK_FINDING(x, part);
            number = old;
        }
    };
    for (const int i : {1, t}) {
        damage(x.factors.at[size_t(i)].f.y, "green f");
        damage(x.factors.at[size_t(i)].pdfToCamera, "density towards the camera");
        damage(x.factors.at[size_t(i)].pdfToLight, "density towards the light");
    }
    damage(x.factors.at[0].f.x, "red f");
    damage(x.factors.at[0].pdfToCamera, "density towards the camera");
    damage(x.factors.at[size_t(k)].f.x, "red f");
    damage(x.factors.at[size_t(k)].pdfToLight, "density towards the light");
    damage(x.factors.edge[1].cosA, "cosine at the light's side");
    damage(x.factors.edge[1].cosB, "cosine at the camera's side");
    damage(x.factors.edge[1].inverseD2, "squared length");

    // Refraction scaled on the wrong side: f without η².
    const double ior = std::get<Dielectric>(x.scene.materialAt(x.path[t]).front.bsdf()).ior;
    x.factors = sound;
    for (const double wrong : {ior * ior, 1 / (ior * ior)}) {
        x.factors.at[size_t(t)].f = sound.at[size_t(t)].f * wrong;
        CHECK_FINDING(x, "red f");
    }
}

TEST_CASE("the validator finds damage at lights without surface") {
    Specimen sky("environment", [](const Path& p) { return p[0].kind == Vertex::Kind::Infinite && p.size() == 4; });
    sky.path[0].position *= 1.01f;
    CHECK_FINDING(sky, "expected 1");
    Specimen bulb("point_light", [](const Path& p) { return p.size() == 4; });
    bulb.path[0].position.x += 1e-3f;
    CHECK_FINDING(bulb, "its emitter is a point without surface at");
    Specimen none("point_light", [](const Path& p) { return p.size() == 4; });
    none.path[0].shape = kNone;
    CHECK_FINDING(none, "belongs to no emitter");
}
