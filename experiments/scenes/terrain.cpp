// A room whose floor is a landscape of very many triangles: no light is hard to find in it, but every ray is dear.

#include "core/base/random.h"
#include "core/scene/generator.h"
#include "experiments/scenes/mesh_builder.h"

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
                      {"sensor",
                       {{"type", "perspective"},
                        {"fov", 60},
                        {"to_world", Json::array({{{"type", "lookat"}, {"origin", {0, 1.2, 0.95}}, {"target", {0, 0.1, -0.3}}, {"up", {0, 1, 0}}}})},
                        {"film", {{"type", "hdrfilm"}, {"width", 256}, {"height", 256}, {"rfilter", {{"type", "box"}}}}}}}};
        scene["terrain"] = landscape();
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

    /// Neighbouring squares share their corners.
    Json landscape() const {
        std::vector<double> positions;
        std::vector<size_t> triangles;
        const auto n = size_t(p_.cells);
        for (size_t i = 0; i <= n; ++i)
            for (size_t j = 0; j <= n; ++j) {
                const double x = 2.0 * double(i) / double(n) - 1, z = 2.0 * double(j) / double(n) - 1;
                positions.insert(positions.end(), {x, height(x, z), z});
            }
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j < n; ++j) {
                const size_t a = i * (n + 1) + j, b = a + n + 1;
                triangles.insert(triangles.end(), {a, a + 1, b + 1, a, b + 1, b});
            }
        return {{"type", "mesh"}, {"positions", positions}, {"triangles", triangles}, {"bsdf", diffuse(0.5)}};
    }

    Parameters p_;
    std::vector<Wave> waves_;
};

ULAM_REGISTER_GENERATOR(Terrain, "terrain", "a room whose floor is a landscape of a million triangles");

}  // namespace
}  // namespace ulam
