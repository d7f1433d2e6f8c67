// Pool: tiles under rippled water, lit by a small sphere. The camera sees the tiles through the water only, and so does the
// light: paths are specular – diffuse – specular, and as the light shrinks neither end finds the other. y up; the water
// fills [−1, 1]² in x and z, its level is y = 0, and the tiled walls stand out a little.

#include "core/base/random.h"
#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

constexpr double kDepth = 0.8, kRim = 0.15, kRimWidth = 1.5;
constexpr double kWater = 1.333;
constexpr int kTiles = 10;
const Spectrum kLightTile{0.75, 0.8, 0.8}, kDarkTile{0.1, 0.35, 0.5};
const Vec3d kLight(-0.5, 2.6, -0.6);
constexpr double kPower = 250;             // of the light, W
constexpr double kSquaresAWavelength = 24;  // of the water's mesh, along its shortest wave

class Pool : public Generator {
public:
    struct Parameters {
        int waves = 8;
        double amplitude = 0.03, wavelength = 0.5, lightRadius = 0.05, seed = 1;
        template <class V>
        void describe(V& v) {
            v("waves", waves, {.help = "sines that the water's surface is the sum of", .min = 1, .max = 64});
            v("amplitude", amplitude, {.help = "of all sines together; each has an equal part", .unit = "m", .min = 0, .max = 0.12});
            v("wavelength", wavelength, {.help = "geometric mean of the sines' wavelengths, which differ by up to a factor of 2", .unit = "m", .min = 0.2, .max = 2});
            v("light_radius", lightRadius, {.help = "of the light; its power stays", .unit = "m", .min = 1e-4, .max = 0.5});
            v("seed", seed, {.help = "chooses directions, lengths and phases of the sines", .min = 0, .max = 1e9});
        }
    };
    explicit Pool(const Parameters& parameters) : p_(parameters) {
        Random random(makeKey(uint64_t(p_.seed)), 0, 0);
        for (int i = 0; i < p_.waves; ++i) {
            const double turn = 2 * kPi * random(), frequency = 2 * kPi / p_.wavelength * std::exp2(random() - 0.5);
            waves_.push_back({frequency * std::cos(turn), frequency * std::sin(turn), 2 * kPi * random()});
        }
    }

    Json expand() const override {
        Json scene = {{"type", "scene"}, {"sensor", View{{0, 2.3, 2.6}, {0, -0.35, 0.05}, {0, 1, 0}, 42}.sensor()}};
        const int cells = int(std::ceil(2 * kSquaresAWavelength * std::sqrt(2.0) / p_.wavelength));
        scene["water"] = smooth(heightField(cells, 1, [&](double x, double z) { return height(x, z); }, glass(0, kWater)));
        addTiles(scene);
        MeshBuilder deck;
        const auto square = [](double w) {
            return std::vector<Vec3d>{{-w, kRim, w}, {w, kRim, w}, {w, kRim, -w}, {-w, kRim, -w}, {-w, kRim, w}};
        };
        deck.strip(square(1), square(kRimWidth));
        scene["deck"] = deck.shape(diffuse(0.5));
        scene["light"] = emitting(sphere(kLight, p_.lightRadius, {}), kPower / (4 * kPi * kPi * p_.lightRadius * p_.lightRadius));
        return scene;
    }

private:
    struct Wave {
        double x, z, phase;
    };

    double height(double x, double z) const {
        double sum = 0;
        for (const Wave& w : waves_) sum += std::sin(w.x * x + w.z * z + w.phase);
        return p_.amplitude * sum / double(waves_.size());
    }

    /// Floor and walls; a row of tiles stands out of the water in part.
    static void addTiles(Json& scene) {
        MeshBuilder light, dark;
        const double side = 2.0 / kTiles;
        const int rows = int(std::ceil((kDepth + kRim) / side));
        for (int i = 0; i < kTiles; ++i) {
            const double a = -1 + i * side, b = a + side;
            for (int j = 0; j < kTiles; ++j) {
                const double c = -1 + j * side, d = c + side;
                ((i + j) % 2 ? light : dark).quad({a, -kDepth, d}, {b, -kDepth, d}, {b, -kDepth, c}, {a, -kDepth, c});
            }
            for (int j = 0; j < rows; ++j) {
                const double y0 = -kDepth + j * side, y1 = std::min(y0 + side, kRim);
                MeshBuilder& mesh = (i + j) % 2 ? dark : light;
                mesh.quad({a, y0, -1}, {b, y0, -1}, {b, y1, -1}, {a, y1, -1});
                mesh.quad({b, y0, 1}, {a, y0, 1}, {a, y1, 1}, {b, y1, 1});
                mesh.quad({-1, y0, b}, {-1, y0, a}, {-1, y1, a}, {-1, y1, b});
                mesh.quad({1, y0, a}, {1, y0, b}, {1, y1, b}, {1, y1, a});
            }
        }
        scene["light_tiles"] = light.shape(diffuse(kLightTile));
        scene["dark_tiles"] = dark.shape(diffuse(kDarkTile));
    }

    Parameters p_;
    std::vector<Wave> waves_;
};

ULAM_REGISTER_GENERATOR(Pool, "pool", "tiles under rippled water, lit by a small light");

}  // namespace
}  // namespace ulam
