// Opacity masks over BSDFs of every kind.

#include "tests/core/scene/bsdf_examples.h"
#include "tests/support/chi_square.h"

using namespace ulam;

namespace {

const std::array kLobes{Lobe::Smooth, Lobe::DeltaReflection, Lobe::DeltaTransmission, Lobe::Null};

}  // namespace

TEST_CASE("a mask lets through what it does not cover, and the nested BSDF has the rest") {
    Random random(makeKey(50), 0, 0);
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& nested) {
            for (const double opacity : {0.0, 0.3, 1.0}) {
                const Masked masked(nested, opacity);
                INFO("BSDF " << any.index() << ", opacity " << opacity);
                CHECK(masked.albedo() == Approx(1 - opacity + opacity * nested.albedo()));
                for (int i = 0; i < 200; ++i) {
                    const Vec3d a(onSphere(random)), b(i % 2 ? Vec3d(onSphere(random)) : -a);
                    for (const Lobe lobe : kLobes) {
                        const Spectrum f = masked.eval(a, b, lobe), inner = nested.eval(a, b, lobe) * opacity;
                        const double straight = lobe == Lobe::Null && a.z * b.z < 0 ? 1 - opacity : 0;
                        for (int c = 0; c < 3; ++c) REQUIRE(f[c] == Approx(inner[c] + straight));
                        REQUIRE(masked.pdf(a, b, lobe) == Approx(nested.pdf(a, b, lobe) * opacity + straight * std::abs(b.z)));
                    }
                }
            }
        });
}

TEST_CASE("a mask chooses lobes with their probabilities, and its numbers are found again") {
    Random random(makeKey(51), 0, 0);
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& nested) {
            const Masked masked(nested, 0.65);
            for (const double z : {0.8, -0.4}) {
                const Vec3f from = directionOf(0.2, z);
                INFO("BSDF " << any.index() << ", cosine " << z);
                // Of the samples that are found: some of the smooth lobe's go below the horizon.
                std::array<double, 4> counts{}, probabilities{};
                const int samples = 20'000;
                double found = 0;
                for (int i = 0; i < samples; ++i) {
                    const auto s = masked.sample(from, random.nextBlock());
                    if (!s) continue;
                    ++found;
                    ++counts[size_t(s->lobe)];
                    probabilities[size_t(s->lobe)] = masked.probability(Vec3d(from), Vec3d(s->to), s->lobe);
                    Block u = random.nextBlock();
                    REQUIRE(masked.invert(from, s->to, s->lobe, u));
                    for (const double number : u) REQUIRE((number >= 0 && number <= 1));
                    const auto again = masked.sample(from, u);
                    REQUIRE(again);
                    REQUIRE(again->lobe == s->lobe);
                    REQUIRE(length(again->to - s->to) < 1e-5f);
                }
                REQUIRE(found > 0);
                if (found == samples) CHECK_FIT(misfit(counts, probabilities));
                if constexpr (masked.hasSmooth)
                    if (found == samples) CHECK(masked.smoothShare(from) == Approx(probabilities[0]));
            }
        });
}

TEST_CASE("light through a mask over a pane is one lobe") {
    const ThinDielectric pane = thinDielectric(1.5);
    const Masked masked(pane, 0.25);
    const Vec3d w(0.6, 0, 0.8), back = -w;
    const double through = pane.probability(w, back, Lobe::Null);
    CHECK(masked.probability(w, back, Lobe::Null) == Approx(0.75 + 0.25 * through));
    CHECK(masked.eval(w, back, Lobe::Null).x == Approx(0.75 + 0.25 * through));
    CHECK(masked.pdf(w, back, Lobe::Null) == Approx((0.75 + 0.25 * through) * 0.8));
    CHECK(masked.probability(w, reflected(w), Lobe::DeltaReflection) == Approx(0.25 * (1 - through)));
    CHECK(masked.hasNull);
    const Diffuse wall = diffuse(0.5);
    const Masked holes(wall, 0.25);
    CHECK(holes.hasDelta);
    CHECK(holes.transmits);
    CHECK(holes.smoothShare(Vec3f(0, 0, 1)) == 0.25);
    Block u{};
    CHECK_FALSE(Masked(wall, 1).invert(Vec3f(0, 0, 1), Vec3f(0, 0, -1), Lobe::Null, u));
    CHECK_FALSE(Masked(wall, 0).invert(Vec3f(0, 0, 1), Vec3f(0, 0, 1), Lobe::Smooth, u));
}
