// MIS plates: glossy plates of growing roughness under spheres of growing size and equal power (Veach and Guibas 1995,
// "Optimally Combining Sampling Techniques for Monte Carlo Rendering", figure 2). Little is hidden here: what a method
// loses against path tracing is its overhead. y up.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

struct Light {
    double x, radius, radiance;
};
constexpr std::array<Light, 4> kLights{{{-3.75, 0.03333, 901.803}, {-1.25, 0.1, 100}, {1.25, 0.3, 11.1111}, {3.75, 0.9, 1.23457}}};

/// From the front edge to the rear edge, in y and z.
struct Plate {
    double frontY, frontZ, rearY, rearZ, alpha;
};
constexpr std::array<Plate, 4> kPlates{{{-2.70651, 0.25609, -2.08375, -0.526323, 0.005},
                                        {-3.28825, 1.36972, -2.83856, 0.476536, 0.02},
                                        {-3.73096, 2.70046, -3.43378, 1.74564, 0.05},
                                        {-3.99615, 4.0667, -3.82069, 3.08221, 0.1}}};
const Spectrum kPlateBase{0.07, 0.09, 0.13};
constexpr double kPlateHalfWidth = 4, kPlateIor = 2;
constexpr double kFloorY = -4.14615, kBackZ = -2, kWallReflectance = 0.4, kFar = 30;  // the walls reach beyond the view

class MisPlates : public Generator {
public:
    struct Parameters {
        double roughness = 1, lightSize = 1;
        template <class V>
        void describe(V& v) {
            v("roughness", roughness, {.help = "factor on the roughness of all plates, which is 0.005, 0.02, 0.05 and 0.1", .min = 0.02, .max = 10});
            v("light_size", lightSize, {.help = "factor on the radii of the four lights; their power stays", .min = 0.01, .max = 2});
        }
    };
    explicit MisPlates(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{0, 2, 15}, {0, -2, 2.5}, {0, 1, 0}, 28, 384, 256}.sensor()}};
        scene["sensor"]["fov_axis"] = "smaller";
        for (size_t i = 0; i < kLights.size(); ++i) {
            const Light& light = kLights[i];
            scene[fmt::format("light_{}", i)] = emitting(sphere({light.x, 0, 0}, light.radius * p_.lightSize, {}),
                                                         light.radiance / (p_.lightSize * p_.lightSize));
        }
        scene["fill_light"] = emitting(sphere({10, 10, 4}, 0.5, {}), 800);
        for (size_t i = 0; i < kPlates.size(); ++i) {
            const Plate& plate = kPlates[i];
            const double w = kPlateHalfWidth;
            MeshBuilder mesh;
            mesh.quad({-w, plate.frontY, plate.frontZ}, {w, plate.frontY, plate.frontZ}, {w, plate.rearY, plate.rearZ}, {-w, plate.rearY, plate.rearZ});
            scene[fmt::format("plate_{}", i)] = mesh.shape(twosided({{"type", "roughplastic"},
                                                                     {"alpha", plate.alpha * p_.roughness},
                                                                     {"int_ior", kPlateIor},
                                                                     {"ext_ior", 1.0},
                                                                     {"diffuse_reflectance", triple(kPlateBase)}}));
        }
        MeshBuilder walls;
        walls.quad({-kFar, kFloorY, kFar}, {kFar, kFloorY, kFar}, {kFar, kFloorY, kBackZ}, {-kFar, kFloorY, kBackZ});
        walls.quad({-kFar, kFloorY, kBackZ}, {kFar, kFloorY, kBackZ}, {kFar, kFar, kBackZ}, {-kFar, kFar, kBackZ});
        scene["walls"] = walls.shape(diffuse(kWallReflectance));
        return scene;
    }

private:
    Parameters p_;
};

ULAM_REGISTER_GENERATOR(MisPlates, "mis_plates", "glossy plates under lights of equal power: a test of overhead");

}  // namespace
}  // namespace ulam
