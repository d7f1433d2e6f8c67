// Egg room: a glass egg on a table, lit by a lamp that shines at the ceiling and by another in a tube (Veach and Guibas
// 1994, "Bidirectional Estimators for Light Transport", figure 5). Light comes indirectly and through glass, but nothing is
// narrow: bidirectional path tracing has a technique for nearly everything, and should win or tie. z up; the front, where
// the camera is, is open.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kX0 = -2.745, kX1 = 1.646, kY0 = -2.208, kY1 = 2.051, kZ0 = -1.941, kZ1 = 1.954;
const Vec3d kEgg(0, 0.60, -0.39);
constexpr double kEggRadius = 0.49 / 2, kEggHeight = 0.62, kAboveTable = 0.001;
constexpr double kTableX = 0.18, kTableY = 0.60, kTableHalfX = 2.32 / 2, kTableHalfY = 1.80 / 2, kTableTop = -0.70;
constexpr double kTableThickness = 0.05, kLeg = 0.055;
const Spectrum kWood{0.33, 0.258, 0.15};
// The floor lamp: a dish on a pole.
constexpr double kLampX = -1.69, kLampY = 0.65, kLampZ = 1.004, kLampHalfX = 0.14, kLampHalfY = 0.11;
constexpr double kDishRim = 1.16, kDishBottom = 0.81, kDishRadius = 0.585, kPole = 0.05, kFootRadius = 0.5;
constexpr double kLampRadiance = 500;
// The spot lamp: an emitter near the closed end of a tube. Its extents, 0.05 × 0.11 × 0.13, say how it is tilted.
const Vec3d kSpot(1.33, 0.86, 0.55), kSpotSide(0, 0.11, 0), kSpotUp(0.05, 0, -0.13);
constexpr double kTubeRadius = 0.166, kTubeAhead = 0.36, kTubeBehind = 0.12;
const Spectrum kSpotRadiance{7000, 5450, 3630};

class EggRoom : public Generator {
public:
    struct Parameters {
        double alpha = 0, ior = 1.5, walls = 0.5;
        template <class V>
        void describe(V& v) {
            v("alpha", alpha, {.help = "roughness of the egg; below 0.0001: smooth", .min = 0, .max = 0.5});
            v("ior", ior, {.help = "index of refraction of the egg", .min = 1.05, .max = 2.5});
            v("walls", walls, {.help = "reflectance of the room", .min = 0, .max = 0.95});
        }
    };
    explicit EggRoom(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{-0.224, -6.642, 0.366}, {-0.224, 0, 0.02}, {0, 0, 1}, 44.55}.sensor()}};
        addRoom(scene);
        addTable(scene);
        scene["egg"] = egg();
        addFloorLamp(scene);
        addSpotLamp(scene);
        return scene;
    }

private:
    void addRoom(Json& scene) const {
        MeshBuilder room;
        const auto section = [](double y) {
            return std::vector<Vec3d>{{kX0, y, kZ0}, {kX0, y, kZ1}, {kX1, y, kZ1}, {kX1, y, kZ0}, {kX0, y, kZ0}};
        };
        const std::vector<Vec3d> back = section(kY1);
        room.strip(section(kY0), back);
        room.quad(back[3], back[2], back[1], back[0]);
        scene["room"] = room.shape(diffuse(p_.walls));
    }

    static void addTable(Json& scene) {
        MeshBuilder table;
        const Vec3d top(kTableX, kTableY, kTableTop), half(kTableHalfX, kTableHalfY, 0);
        table.box(top - half - Vec3d(0, 0, kTableThickness), top + half);
        for (const double x : {-kTableHalfX, kTableHalfX - 2 * kLeg})
            for (const double y : {-kTableHalfY, kTableHalfY - 2 * kLeg}) {
                const Vec3d foot(kTableX + x, kTableY + y, kZ0);
                table.box(foot, Vec3d(foot.x + 2 * kLeg, foot.y + 2 * kLeg, kTableTop - kTableThickness));
            }
        scene["table"] = table.shape(diffuse(kWood));
    }

    /// Around the z axis: the profile turns around y, and (x, y, z) becomes (z, x, y), a rotation.
    static Json aroundZ(const std::vector<Imath::V2d>& profile, int sides, const Vec3d& base, const Json& bsdf) {
        MeshBuilder mesh;
        mesh.revolution(profile, {base.y, base.z, base.x}, sides);
        Json shape = mesh.shape(bsdf);
        Json& p = shape["positions"];
        for (size_t i = 0; i < p.size(); i += 3) {
            const Json z = p[i + 1];
            p[i + 1] = p[i];
            p[i] = p[i + 2];
            p[i + 2] = z;
        }
        return smooth(shape);
    }

    Json egg() const {
        constexpr int kProfile = 96, kSides = 160;
        std::vector<Imath::V2d> profile;
        for (int i = 0; i <= kProfile; ++i) {
            const double angle = kPi * (double(i) / kProfile - 0.5);
            profile.emplace_back(i == 0 || i == kProfile ? 0 : kEggRadius * std::cos(angle), kEggHeight / 2 * std::sin(angle));
        }
        return aroundZ(profile, kSides, kEgg + Vec3d(0, 0, kAboveTable), glass(p_.alpha, p_.ior));
    }

    static void addFloorLamp(Json& scene) {
        const Json brass = metal("Au", 0.25);
        const Vec3d foot(kLampX, kLampY, kZ0), up(0, 0, 1);
        constexpr int kProfile = 24, kSides = 96;
        std::vector<Imath::V2d> dish, base;
        for (int i = 0; i <= kProfile; ++i) {
            const double angle = kPi / 2 * i / kProfile;
            dish.emplace_back(kDishRadius * std::sin(angle), (kDishRim - kDishBottom) * (1 - std::cos(angle)));
            base.emplace_back(i == kProfile ? 0 : kFootRadius * std::cos(angle), 0.3 * kFootRadius * std::sin(angle));
        }
        scene["dish"] = aroundZ(dish, kSides, {kLampX, kLampY, kDishBottom}, twosided(brass));
        scene["foot"] = aroundZ(base, kSides, foot, twosided(brass));
        scene["pole"] = tube(foot, foot + up * (kDishBottom - kZ0), kPole, brass);
        MeshBuilder lamp;
        const double x = kLampHalfX, y = kLampHalfY;
        const Vec3d middle(kLampX, kLampY, kLampZ);
        lamp.quad(middle + Vec3d(-x, -y, 0), middle + Vec3d(x, -y, 0), middle + Vec3d(x, y, 0), middle + Vec3d(-x, y, 0));
        scene["lamp"] = emitting(lamp.shape({}), kLampRadiance);
    }

    static void addSpotLamp(Json& scene) {
        const Vec3d half = (kSpotSide + kSpotUp) / 2, other = (kSpotSide - kSpotUp) / 2, axis = kSpotSide.cross(kSpotUp).normalized();
        MeshBuilder spot;
        spot.quad(kSpot - half, kSpot + other, kSpot + half, kSpot - other);
        scene["spot"] = emitting(spot.shape({}), kSpotRadiance);
        const Vec3d closed = kSpot - axis * kTubeBehind;
        scene["tube"] = tube(closed, kSpot + axis * kTubeAhead, kTubeRadius, diffuse(0.5));
        scene["tube_end"] = disk(closed, kSpot, kTubeRadius);
        scene["tube_end"]["bsdf"] = twosided(diffuse(0.5));
    }

    Parameters p_;
};

ULAM_REGISTER_GENERATOR(EggRoom, "egg_room", "a glass egg lit by a ceiling lamp and a spot lamp: a control");

}  // namespace
}  // namespace ulam
