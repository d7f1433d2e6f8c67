// Metal ring: an open cylinder that stands on the floor; light that comes in over its edge and is reflected by the inside
// makes the caustic seen in cups. Seen from above, the reflected rays are those of a circle in the plane (a mirror of
// vertical walls keeps a ray's slope), so the cusp of the caustic is where mirrors of radius R focus: with the light at
// the horizontal distance s from the wall that it shines on, at R − sR / (2s − R) from the axis, away from the light
// (from R / 2 on, as the light gets nearer). y up; the axis is x = z = 0, light comes from −x.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kLightDistance = 10;  // from the middle of the ring's foot, in radii of the ring
constexpr double kFloorHalf = 3;       // in radii
constexpr double kIrradiance = 4;

class Ring : public Generator {
public:
    struct Parameters {
        double radius = 1, height = 0.5, alpha = 0, lightAngle = 30, lightWidth = 0.53;
        template <class V>
        void describe(V& v) {
            v("radius", radius, {.help = "of the ring; camera, floor and light scale with it", .min = 0.01, .max = 100});
            v("height", height, {.help = "of the ring, in radii; the cusp is lit if it is from 0.46 to 1.9 times the tangent of light_angle (of up to 60°)", .min = 0.05, .max = 2});
            v("alpha", alpha, {.help = "roughness of the metal; below 0.0001: smooth", .min = 0, .max = 0.5});
            v("light_angle", lightAngle, {.help = "of the light above the floor", .unit = "degrees", .min = 10, .max = 80});
            v("light_width", lightWidth, {.help = "angle under which the middle sees the light; 0.53: the sun. The irradiance stays", .unit = "degrees", .min = 0.05, .max = 20});
        }
    };
    explicit Ring(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        const double r = p_.radius, w = kFloorHalf * r, angle = p_.lightAngle * kPi / 180;
        Json scene = {{"type", "scene"}, {"sensor", View{Vec3d(0.7, 4.2, 4.2) * r, Vec3d(0, 0.1, 0.1) * r, {0, 1, 0}, 34}.sensor()}};
        MeshBuilder floor;
        floor.quad({-w, 0, w}, {w, 0, w}, {w, 0, -w}, {-w, 0, -w});
        scene["floor"] = floor.shape(diffuse(0.6));
        scene["ring"] = tube({0, 0, 0}, {0, p_.height * r, 0}, r, metal("Au", p_.alpha));
        scene["light"] = discLight(Vec3d(-std::cos(angle), std::sin(angle), 0) * (kLightDistance * r), {0, 0, 0}, p_.lightWidth, kIrradiance);
        return scene;
    }

private:
    Parameters p_;
};

ULAM_REGISTER_GENERATOR(Ring, "ring", "a metal ring and the caustic inside it");

}  // namespace
}  // namespace ulam
