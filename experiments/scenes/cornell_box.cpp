// Cornell box: the measured room of the Cornell University Program of Computer Graphics (Goral et al. 1984; data of
// 1998), in millimetres, 552.8 × 548.8 × 559.2, with its blocks, diffuse or glossy, or with glass and mirror in their place.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

const Spectrum kWhite{0.725, 0.71, 0.68}, kRed{0.63, 0.065, 0.05}, kGreen{0.14, 0.45, 0.091};
constexpr double kHeight = 548.8;
constexpr double kLightY = 548.3;  // just below the ceiling

/// A block that stands on the floor; corners of its base in the order of the measurements (clockwise from above).
Json block(const std::array<std::pair<double, double>, 4>& base, double height, const Json& bsdf) {
    MeshBuilder mesh;
    const auto corner = [&](size_t i, double y) { return Vec3d(base[i % 4].first, y, base[i % 4].second); };
    mesh.quad(corner(0, height), corner(1, height), corner(2, height), corner(3, height));
    for (size_t i = 0; i < 4; ++i) mesh.quad(corner(i, 0), corner(i + 1, 0), corner(i + 1, height), corner(i, height));
    return mesh.shape(bsdf);
}

class CornellBox : public Generator {
public:
    struct Parameters {
        std::string variant = "plain";
        double alpha = 0.05;
        Spectrum radiance{51, 36, 12};  // the image's mean is near 0.5
        template <class V>
        void describe(V& v) {
            v("variant", variant,
              {.help = "plain: two white blocks; glass_and_mirror: a glass sphere for the short block, the tall one a "
                       "mirror; glass_sphere: nothing but one glass sphere; glossy: the tall block of rough metal, the short one "
                       "of rough plastic",
               .choices = {"plain", "glass_and_mirror", "glass_sphere", "glossy"}});
            v("alpha", alpha, {.help = "roughness of the glossy blocks", .min = 0.005, .max = 0.3});
            v("radiance", radiance, {.help = "of the lamp", .unit = "W/(m² sr)", .min = 0});
        }
    };
    explicit CornellBox(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{278, 273, -800}, {278, 273, -799}, {0, 1, 0}, 39.3077}.sensor()}};
        addRoom(scene);
        addContent(scene);
        return scene;
    }

private:
    void addRoom(Json& scene) const {
        MeshBuilder white, red, green, light;
        white.quad({552.8, 0, 0}, {0, 0, 0}, {0, 0, 559.2}, {549.6, 0, 559.2});
        white.quad({556, kHeight, 0}, {556, kHeight, 559.2}, {0, kHeight, 559.2}, {0, kHeight, 0});
        white.quad({549.6, 0, 559.2}, {0, 0, 559.2}, {0, kHeight, 559.2}, {556, kHeight, 559.2});
        green.quad({0, 0, 559.2}, {0, 0, 0}, {0, kHeight, 0}, {0, kHeight, 559.2});
        red.quad({552.8, 0, 0}, {549.6, 0, 559.2}, {556, kHeight, 559.2}, {556, kHeight, 0});
        light.quad({343, kLightY, 227}, {343, kLightY, 332}, {213, kLightY, 332}, {213, kLightY, 227});
        scene["room"] = white.shape(diffuse(kWhite));
        scene["red_wall"] = red.shape(diffuse(kRed));
        scene["green_wall"] = green.shape(diffuse(kGreen));
        scene["light"] = emitting(light.shape({}), p_.radiance);
    }

    void addContent(Json& scene) const {
        constexpr std::array<std::pair<double, double>, 4> kShort{{{130, 65}, {82, 225}, {240, 272}, {290, 114}}};
        constexpr std::array<std::pair<double, double>, 4> kTall{{{423, 247}, {265, 296}, {314, 456}, {472, 406}}};
        const Json glass = {{"type", "dielectric"}};
        if (p_.variant == "glass_sphere") {
            scene["sphere"] = sphere({278, 120, 279.6}, 120, glass);
            return;
        }
        Json tall = diffuse(kWhite), low = diffuse(kWhite);
        if (p_.variant == "glossy") {
            tall = metal("Al", p_.alpha);
            low = {{"type", "roughplastic"}, {"alpha", p_.alpha}, {"diffuse_reflectance", triple(kWhite)}};
        }
        if (p_.variant == "glass_and_mirror") tall = {{"type", "conductor"}};
        scene["tall"] = block(kTall, 330, tall);
        scene["short"] = p_.variant == "glass_and_mirror" ? sphere({185.5, 82.5, 169}, 82.5, glass) : block(kShort, 165, low);
    }

    Parameters p_;
};

ULAM_REGISTER_GENERATOR(CornellBox, "cornell_box", "the Cornell box, also with glass and mirror");

}  // namespace
}  // namespace ulam
