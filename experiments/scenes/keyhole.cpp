// Keyhole box: two boxes, one on the other, and small holes in the slab between them. The lamp lies close above the slab
// and faces up, beside the holes: the lower box gets indirect light only, and all of it through the holes. y up.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kX0 = -1.02, kX1 = 1.0, kZ0 = -1.04, kZ1 = 0.99;
constexpr double kCeiling = 1.99, kTop = 3.783, kSlab = 0.02;
constexpr double kHoleX = 0.154 + 0.174, kHoleZ = 0.14 + 0.19;  // its axis is that of the box
constexpr double kAxisX = (kX0 + kX1) / 2, kAxisZ = (kZ0 + kZ1) / 2;
constexpr double kLampY = 2.048, kLampHalfX = 0.235, kLampHalfZ = 0.19;
constexpr double kLampDX = -(0.907 + 0.437) / 2 - kAxisX, kLampDZ = (0.098 + 0.478) / 2 - kAxisZ;  // from the holes' axis
const Spectrum kWhite{0.725, 0.71, 0.68}, kRed{0.63, 0.065, 0.05}, kGreen{0.14, 0.45, 0.091};

class Keyhole : public Generator {
public:
    struct Parameters {
        double holeSize = 1, lampOffset = std::hypot(kLampDX, kLampDZ), radiance = 4000;
        int holes = 1;
        template <class V>
        void describe(V& v) {
            v("hole_size", holeSize, {.help = "factor on the sides of the openings; 1: they are 2.6 % of the ceiling", .min = 0.02, .max = 4});
            v("holes", holes, {.help = "holes a side; together as large as one", .min = 1, .max = 16});
            v("lamp_offset", lampOffset, {.help = "distance of the lamp's middle from the axis of the boxes", .min = 0, .max = 0.85});
            v("radiance", radiance, {.help = "of the lamp", .unit = "W/(m² sr)", .min = 0});
        }
    };
    explicit Keyhole(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{0, 1, 6.8}, {0, 1, 0}, {0, 1, 0}, 19.5}.sensor()}};
        addBoxes(scene);
        scene["slab"] = slab().shape(diffuse(kWhite));
        MeshBuilder lamp;
        const double scale = p_.lampOffset / std::hypot(kLampDX, kLampDZ), x = kAxisX + scale * kLampDX, z = kAxisZ + scale * kLampDZ;
        lamp.quad({x - kLampHalfX, kLampY, z + kLampHalfZ}, {x + kLampHalfX, kLampY, z + kLampHalfZ},
                  {x + kLampHalfX, kLampY, z - kLampHalfZ}, {x - kLampHalfX, kLampY, z - kLampHalfZ});
        scene["lamp"] = emitting(lamp.shape({}), p_.radiance);
        return scene;
    }

    Features features() const override {
        // Half way through the slab: nothing but the openings is there.
        Features features{Vec3f(float(kX0), float(kCeiling + kSlab / 2), float(kZ0)), Vec3f(float(kX1 - kX0), 0, 0),
                          Vec3f(0, 0, float(kZ1 - kZ0)), p_.holes, p_.holes, {}};
        for (int row = 0; row < p_.holes; ++row)
            for (int column = 0; column < p_.holes; ++column) features.names.push_back(fmt::format("hole_{}_{}", row, column));
        return features;
    }

private:
    /// Counter-clockwise from above, closed.
    static std::vector<Vec3d> outline(double x0, double x1, double z0, double z1, double y) {
        return {{x0, y, z1}, {x1, y, z1}, {x1, y, z0}, {x0, y, z0}, {x0, y, z1}};
    }

    void addBoxes(Json& scene) const {
        MeshBuilder white, red, green, upper, blocks;
        const auto floor = outline(kX0, kX1, kZ0, kZ1, 0), ceiling = outline(kX0, kX1, kZ0, kZ1, kCeiling);
        white.quad(floor[0], floor[1], floor[2], floor[3]);
        white.quad(floor[3], floor[2], ceiling[2], ceiling[3]);
        red.quad(floor[0], floor[3], ceiling[3], ceiling[0]);
        green.quad(floor[2], floor[1], ceiling[1], ceiling[2]);
        const auto low = outline(kX0, kX1, kZ0, kZ1, kCeiling + kSlab), high = outline(kX0, kX1, kZ0, kZ1, kTop);
        upper.strip(low, high);
        upper.quad(high[3], high[2], high[1], high[0]);
        blocks.box({-0.720444, 0, -0.473883}, {0.573552, 0, -0.199597}, {0, 1.2, 0}, {0.196458, 0, 0.564532});
        blocks.box({-0.046075, 0, 0.573007}, {0.170329, 0, -0.569902}, {0, 0.6, 0}, {0.579084, 0, 0.173073});
        scene["lower_box"] = white.shape(diffuse(kWhite));
        scene["red_wall"] = red.shape(diffuse(kRed));
        scene["green_wall"] = green.shape(diffuse(kGreen));
        scene["upper_box"] = upper.shape(diffuse(kWhite));
        scene["blocks"] = blocks.shape(diffuse(kWhite));
    }

    MeshBuilder slab() const {
        MeshBuilder mesh;
        const double pitchX = (kX1 - kX0) / p_.holes, pitchZ = (kZ1 - kZ0) / p_.holes;
        const double w = kHoleX * p_.holeSize / p_.holes / 2, h = kHoleZ * p_.holeSize / p_.holes / 2;
        for (int row = 0; row < p_.holes; ++row)
            for (int column = 0; column < p_.holes; ++column) {
                const double x0 = kX0 + column * pitchX, x1 = kX0 + (column + 1) * pitchX, x = (x0 + x1) / 2;
                const double z0 = kZ0 + row * pitchZ, z1 = kZ0 + (row + 1) * pitchZ, z = (z0 + z1) / 2;
                const auto cell = [&](double y) { return outline(x0, x1, z0, z1, y); };
                const auto hole = [&](double y) { return outline(x - w, x + w, z - h, z + h, y); };
                mesh.strip(hole(kCeiling + kSlab), cell(kCeiling + kSlab));
                mesh.strip(cell(kCeiling), hole(kCeiling));
                mesh.strip(hole(kCeiling), hole(kCeiling + kSlab));
            }
        return mesh;
    }

    Parameters p_;
};

ULAM_REGISTER_GENERATOR(Keyhole, "keyhole", "a box lit through small holes in its ceiling, indirectly only");

}  // namespace
}  // namespace ulam
