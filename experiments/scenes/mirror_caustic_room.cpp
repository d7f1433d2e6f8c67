// Mirror-caustic room: a closed room, the sun through a window, and a mirror on the floor. The sun's parallel light falls
// on a patch of the floor that is the window's image; the mirror covers a given share of it and sends just that share of
// the light on to a wall. A chain must give the caustic, and the bright patch beside it, the time that each deserves. y up.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kHalf = 1, kHeight = 2;
constexpr double kWindowY0 = 1.1, kWindowY1 = 1.6, kWindowHalfZ = 0.4;
constexpr double kMirrorY = 0.002, kMargin = 0.03;  // the mirror reaches beyond the light on three sides
constexpr double kElevation = 50 * kPi / 180;       // of the sun, which shines towards −x
constexpr double kIrradiance = 20;

class MirrorCausticRoom : public Generator {
public:
    struct Parameters {
        double share = 0.1, walls = 0.6;
        template <class V>
        void describe(V& v) {
            v("share", share, {.help = "of the sun's light that meets the mirror, exactly", .min = 1e-5, .max = 1});
            v("walls", walls, {.help = "reflectance of the room", .min = 0, .max = 0.95});
        }
    };
    explicit MirrorCausticRoom(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{0.9, 1.3, 0.92}, {-0.7, 0.5, -0.25}, {0, 1, 0}, 62}.sensor()}};
        MeshBuilder room, mirror;
        const auto section = [](double y) {
            return std::vector<Vec3d>{{-kHalf, y, kHalf}, {-kHalf, y, -kHalf}, {kHalf, y, -kHalf}, {kHalf, y, kHalf}};
        };
        const std::vector<Vec3d> low = section(0), high = section(kHeight);
        room.quad(low[0], low[3], low[2], low[1]);
        room.quad(high[0], high[1], high[2], high[3]);
        for (const size_t i : {0, 1, 3}) {  // the wall +x has the window
            const size_t j = (i + 1) % 4;
            room.quad(low[i], low[j], high[j], high[i]);
        }
        const auto rectangle = [](double y0, double y1, double halfZ) {
            return std::vector<Vec3d>{{kHalf, y0, -halfZ}, {kHalf, y0, halfZ}, {kHalf, y1, halfZ}, {kHalf, y1, -halfZ}, {kHalf, y0, -halfZ}};
        };
        room.strip(rectangle(kWindowY0, kWindowY1, kWindowHalfZ), rectangle(0, kHeight, kHalf));
        scene["room"] = room.shape(diffuse(p_.walls));

        const double x0 = landing(kWindowY1) - kMargin, x1 = landing(kWindowY0) + kMargin;
        const double z0 = -kWindowHalfZ - kMargin, z1 = kWindowHalfZ * (2 * p_.share - 1);
        mirror.quad({x0, kMirrorY, z1}, {x1, kMirrorY, z1}, {x1, kMirrorY, z0}, {x0, kMirrorY, z0});
        scene["mirror"] = mirror.shape({{"type", "conductor"}});
        scene["sun"] = {{"type", "directional"},
                        {"direction", {-std::cos(kElevation), -std::sin(kElevation), 0.0}},
                        {"irradiance", kIrradiance}};
        return scene;
    }

    Features features() const override {
        const float z = float(kWindowHalfZ);
        return {{float(kHalf), float(kWindowY1), z}, {0, 0, -2 * z}, {0, float(kWindowY0 - kWindowY1), 0}, 1, 1, {"window"}};
    }

private:
    /// Where light through the window at height y meets the mirror's plane.
    static double landing(double y) { return kHalf - (y - kMirrorY) / std::tan(kElevation); }

    Parameters p_;
};

ULAM_REGISTER_GENERATOR(MirrorCausticRoom, "mirror_caustic_room", "sunlight of which a mirror sends a known share to a caustic");

}  // namespace
}  // namespace ulam
