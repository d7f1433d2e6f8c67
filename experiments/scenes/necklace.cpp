// Necklace: glossy beads of equal size on a closed curve on the floor. Every bead has highlights of the light and, in them,
// images of its neighbours: many small bright regions of equal importance, and the more beads, the more a chain has to
// visit. y up; the curve is r(φ) = 1 + 0.25 cos 3φ around the y axis, with the beads at equal distances along it.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kBulge = 0.25;
constexpr int kLobes = 3;
constexpr double kGap = 0.02;  // between neighbours, as a fraction of their distance
constexpr double kFloorHalf = 4, kIrradiance = 3;
const Vec3d kLight(-4, 5, -3);

class Necklace : public Generator {
public:
    struct Parameters {
        int beads = 64;
        double alpha = 0.05, lightWidth = 2;
        template <class V>
        void describe(V& v) {
            v("beads", beads, {.help = "spheres on the curve", .min = 8, .max = 2000});
            v("alpha", alpha, {.help = "roughness of their metal; below 0.0001: smooth", .min = 0, .max = 0.5});
            v("light_width", lightWidth, {.help = "angle under which the curve's middle sees the light; the irradiance stays", .unit = "degrees", .min = 0.1, .max = 20});
        }
    };
    explicit Necklace(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{0.4, 2.9, 3.2}, {0, 0, 0.1}, {0, 1, 0}, 34}.sensor()}};
        MeshBuilder floor;
        const double w = kFloorHalf;
        floor.quad({-w, 0, w}, {w, 0, w}, {w, 0, -w}, {-w, 0, -w});
        scene["floor"] = floor.shape(diffuse(0.4));
        scene["metal"] = metal("Au", p_.alpha);
        const std::vector<Vec3d> feet = places();
        double nearest = 1e9;
        for (size_t i = 0; i < feet.size(); ++i) nearest = std::min(nearest, (feet[i] - feet[(i + 1) % feet.size()]).length());
        const double radius = nearest * (1 - kGap) / 2;
        for (size_t i = 0; i < feet.size(); ++i)
            scene[fmt::format("bead_{}", i)] = sphere(feet[i] + Vec3d(0, radius, 0), radius, {{"type", "ref"}, {"id", "metal"}});
        scene["light"] = discLight(kLight, {0, 0, 0}, p_.lightWidth, kIrradiance);
        return scene;
    }

private:
    static Vec3d onCurve(double turn) {
        const double r = 1 + kBulge * std::cos(kLobes * turn);
        return {r * std::cos(turn), 0, r * std::sin(turn)};
    }

    /// At equal distances along a polygon of many corners on the curve.
    std::vector<Vec3d> places() const {
        constexpr int kCorners = 1 << 16;
        std::vector<double> length(kCorners + 1, 0);
        const auto corner = [](int i) { return onCurve(2 * kPi * i / kCorners); };
        for (int i = 0; i < kCorners; ++i) length[size_t(i + 1)] = length[size_t(i)] + (corner(i + 1) - corner(i)).length();
        std::vector<Vec3d> result;
        for (int i = 0; i < p_.beads; ++i) {
            const double along = length.back() * i / p_.beads;
            const auto after = std::upper_bound(length.begin(), length.end(), along);
            result.push_back(corner(int(after - length.begin()) - 1));
        }
        return result;
    }

    Parameters p_;
};

ULAM_REGISTER_GENERATOR(Necklace, "necklace", "glossy beads on a curve: many small highlights");

}  // namespace
}  // namespace ulam
