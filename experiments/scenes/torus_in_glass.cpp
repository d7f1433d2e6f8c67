// Torus in a glass block: a diffuse torus that light reaches, and the camera sees, through glass only. If the glass is
// smooth, every path to it is specular on both sides (specular – diffuse – specular), which no connection can make: path
// tracing must hit the light by chance, and the smaller the light, the seldomer. y up.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kAboveFloor = 0.01, kIor = 1.5;
const Vec3d kMiddle(0, 1 + kAboveFloor, 0);         // of a block of side 2
const Vec3d kLight = kMiddle + Vec3d(-4, 6, 2.5);  // seen over the left shoulder
constexpr double kMajor = 0.6, kMinor = 0.22;
constexpr double kFloorHalf = 8, kIrradiance = 5;

class TorusInGlass : public Generator {
public:
    struct Parameters {
        double alpha = 0, lightWidth = 1;
        template <class V>
        void describe(V& v) {
            v("alpha", alpha, {.help = "roughness of the glass; below 0.0001: smooth", .min = 0, .max = 0.5});
            v("light_width", lightWidth, {.help = "angle under which the block's middle would see the light through air; the light's irradiance there stays", .unit = "degrees", .min = 0.25, .max = 5});
        }
    };
    explicit TorusInGlass(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{3.9, 4.4, 5.0}, {0, 0.85, 0}, {0, 1, 0}, 34.6}.sensor()}};
        MeshBuilder torus, block, floor;
        constexpr int kProfile = 64, kSides = 160;
        std::vector<Imath::V2d> profile;
        for (int i = 0; i <= kProfile; ++i) {
            const double angle = 2 * kPi * (i % kProfile) / kProfile;
            profile.emplace_back(kMajor + kMinor * std::cos(angle), kMinor * std::sin(angle));
        }
        torus.revolution(profile, kMiddle, kSides);
        block.box(kMiddle - Vec3d(1.0), kMiddle + Vec3d(1.0));
        const double w = kFloorHalf;
        floor.quad({-w, 0, w}, {w, 0, w}, {w, 0, -w}, {-w, 0, -w});
        scene["torus"] = smooth(torus.shape(diffuse(Spectrum(0.8, 0.4, 0.15))));
        scene["block"] = block.shape(glass(p_.alpha, kIor));
        scene["floor"] = floor.shape(diffuse(0.4));
        scene["light"] = discLight(kLight, kMiddle, p_.lightWidth, kIrradiance);
        return scene;
    }

private:
    Parameters p_;
};

ULAM_REGISTER_GENERATOR(TorusInGlass, "torus_in_glass", "a diffuse torus inside a block of glass under a small light");

}  // namespace
}  // namespace ulam
