// A room whose floor is a landscape of very many triangles: no light is hard to find in it, but every ray is dear.

#include "core/base/random.h"
#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

class Terrain : public Generator {
public:
    struct Parameters {
        int cells = 708;
        double relief = 0.3;
        double seed = 1;
        template <class V>
        void describe(V& v) {
            v("cells", cells, {.help = "squares a side, of two triangles each; 708: a million triangles", .min = 1, .max = 4000});
            v("relief", relief, {.help = "height of the largest waves", .unit = "m", .min = 0, .max = 0.6});
            v("seed", seed, {.help = "chooses the landscape", .min = 0, .max = 1e9});
        }
    };
    explicit Terrain(const Parameters& parameters) : p_(parameters) {
        Random random(makeKey(uint64_t(p_.seed)), 0, 0);
        for (int octave = 0; octave < kOctaves; ++octave)
            for (int i = 0; i < kWavesAnOctave; ++i) {
                const double turn = 2 * kPi * random(), frequency = 1.5 * kPi * std::exp2(octave + random());
                waves_.push_back({frequency * std::cos(turn), frequency * std::sin(turn), 2 * kPi * random(), std::exp2(-octave) / kWavesAnOctave});
            }
    }

    Json expand() const override {
        MeshBuilder room, lamp;
        room.quad({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1});
        room.quad({-1, kBottom, -1}, {1, kBottom, -1}, {1, 2, -1}, {-1, 2, -1});
        room.quad({1, kBottom, 1}, {-1, kBottom, 1}, {-1, 2, 1}, {1, 2, 1});
        room.quad({-1, kBottom, 1}, {-1, kBottom, -1}, {-1, 2, -1}, {-1, 2, 1});
        room.quad({1, kBottom, -1}, {1, kBottom, 1}, {1, 2, 1}, {1, 2, -1});
        lamp.quad({-0.3, 1.99, -0.3}, {0.3, 1.99, -0.3}, {0.3, 1.99, 0.3}, {-0.3, 1.99, 0.3});
        Json scene = {{"type", "scene"},
                      {"sensor", View{{0, 1.2, 0.95}, {0, 0.1, -0.3}, {0, 1, 0}, 60}.sensor()}};
        scene["terrain"] = heightField(p_.cells, 1, [&](double x, double z) { return height(x, z); }, diffuse(0.5));
        scene["room"] = room.shape(diffuse(0.7));
        scene["lamp"] = emitting(lamp.shape({}), 20);
        return scene;
    }

private:
    static constexpr int kOctaves = 7, kWavesAnOctave = 3;
    static constexpr double kBottom = -1;  // below every valley

    struct Wave {
        double x, z, phase, amplitude;
    };

    double height(double x, double z) const {
        double sum = 0;
        for (const Wave& w : waves_) sum += w.amplitude * std::sin(w.x * x + w.z * z + w.phase);
        return p_.relief * sum;
    }

    Parameters p_;
    std::vector<Wave> waves_;
};

ULAM_REGISTER_GENERATOR(Terrain, "terrain", "a room whose floor is a landscape of a million triangles");

}  // namespace
}  // namespace ulam
