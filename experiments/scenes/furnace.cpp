// Furnace: a closed sphere that reflects and emits so much that radiance is 1 everywhere.

#include "core/scene/generator.h"
#include "experiments/scenes/closed_sphere.h"
#include "experiments/scenes/mesh_builder.h"

namespace ulam {
namespace {

class Furnace : public Generator {
public:
    struct Parameters {
        double reflectance = 0.5;
        int maxDepth = 8;
        template <class V>
        void describe(V& v) {
            v("reflectance", reflectance, {.help = "of the sphere", .min = 0, .max = 1, .maxExclusive = true});
            v("max_depth", maxDepth,
              {.help = "radiance is 1 for paths of up to so many edges, as the sampler's max_depth; 0: of any length",
               .min = 0});
        }
    };
    explicit Furnace(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json sphere = hollowSphere(p_.reflectance);
        // A path of k edges is reflected k − 1 times.
        sphere["emitter"] = areaEmitter(1 / geometricSeries(p_.reflectance, p_.maxDepth));
        return {{"type", "scene"}, {"sensor", sensorInsideSphere()}, {"sphere", sphere}};
    }

    std::optional<Image> truth(const FilmSize& film) const override {
        return Image(film.cropWidth, film.cropHeight, Rgb(1));
    }

private:
    Parameters p_;
};

ULAM_REGISTER_GENERATOR(Furnace, "furnace", "closed glowing sphere: radiance 1 everywhere");

}  // namespace
}  // namespace ulam
