// A closed diffuse sphere lit by a point light at its centre: every point gets the same light, directly and from every
// number of reflections, so the radiance is I ρ / (π r²) (1 + ρ + ρ² + …).

#include "core/scene/generator.h"
#include "experiments/scenes/closed_sphere.h"

namespace ulam {
namespace {

class SphereLightCenter : public Generator {
public:
    struct Parameters {
        double reflectance = 0.5, intensity = 0;
        int maxDepth = 8;
        template <class V>
        void describe(V& v) {
            v("reflectance", reflectance,
              {.help = "of the sphere, whose radius is 1",
               .min = 0,
               .max = 1,
               .minExclusive = true,
               .maxExclusive = true});
            v("intensity", intensity,
              {.help = "of the light; 0: chosen so that the radiance is 0.5", .unit = "W/sr", .min = 0});
            v("max_depth", maxDepth,
              {.help =
                   "the known image counts paths of up to so many edges, as the sampler's max_depth; 0: of any length",
               .min = 0});
        }
    };
    explicit SphereLightCenter(const Parameters& parameters) : p_(parameters) {
        // A path of k edges is reflected k − 1 times; the light itself is never seen.
        radiancePerIntensity_ =
            p_.maxDepth == 1 ? 0 : p_.reflectance / kPi * geometricSeries(p_.reflectance, p_.maxDepth - 1);
        intensity_ = p_.intensity > 0 || radiancePerIntensity_ == 0 ? p_.intensity : 0.5 / radiancePerIntensity_;
    }

    Json expand() const override {
        return {{"type", "scene"},
                {"sensor", sensorInsideSphere()},
                {"sphere", hollowSphere(p_.reflectance)},
                {"light", {{"type", "point"}, {"intensity", intensity_}}}};
    }

    std::optional<Image> truth(const FilmSize& film) const override {
        return Image(film.cropWidth, film.cropHeight, Rgb(float(intensity_ * radiancePerIntensity_)));
    }

private:
    Parameters p_;
    double radiancePerIntensity_, intensity_;
};

ULAM_REGISTER_GENERATOR(SphereLightCenter, "sphere_light_center",
                        "closed sphere with a point light at its centre: the same radiance everywhere");

}  // namespace
}  // namespace ulam
