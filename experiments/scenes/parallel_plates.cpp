// Two unit squares that face each other, one emits, the other reflects diffusely and is what the camera sees. The image
// follows from Lambert's formula, its mean from the form factor of the squares (Howell's catalogue, C-11).

#include "core/scene/generator.h"
#include "experiments/scenes/apertures.h"
#include "experiments/scenes/mesh_builder.h"
#include "experiments/scenes/receiver_view.h"

namespace ulam {
namespace {

/// Fraction of the light of one unit square that reaches the other at this distance.
double formFactor(double distance) {
    const double x = 1 / distance, x2 = x * x, root = std::sqrt(1 + x2);
    return 2 / (kPi * x2) *
           (std::log((1 + x2) / std::sqrt(1 + 2 * x2)) + 2 * x * root * std::atan(x / root) - 2 * x * std::atan(x));
}

class ParallelPlates : public Generator {
public:
    struct Parameters {
        double distance = 1, reflectance = 0.8, radiance = 0;
        template <class V>
        void describe(V& v) {
            v("distance", distance, {.help = "between the squares, whose sides are 1", .min = 0.02, .max = 100});
            v("reflectance", reflectance,
              {.help = "of the receiver; the emitter is black", .min = 0, .max = 1, .minExclusive = true});
            v("radiance", radiance,
              {.help = "of the emitter; 0: chosen so that the image's mean is 0.5", .unit = "W/(m² sr)", .min = 0});
        }
    };
    explicit ParallelPlates(const Parameters& parameters) : p_(parameters), view_{p_.distance} {
        radiance_ = p_.radiance > 0 ? p_.radiance : 0.5 / (p_.reflectance * formFactor(p_.distance));
    }

    Json expand() const override {
        MeshBuilder emitter, receiver;
        const double h = 0.5, d = p_.distance;
        emitter.quad({-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0});
        receiver.quad({-h, -h, d}, {-h, h, d}, {h, h, d}, {h, -h, d});
        return {{"type", "scene"},
                {"sensor", view_.sensor()},
                {"emitter", emitting(emitter.shape(diffuse(0)), radiance_)},
                {"receiver", receiver.shape(diffuse(p_.reflectance))}};
    }

    std::optional<Image> truth(const FilmSize& film) const override {
        const ReceiverView::Square seen = view_.image(film);
        if (std::max({-seen.x0, seen.x1, -seen.y0, seen.y1}) > 0.5 + 1e-9) return std::nullopt;
        const Hole opening{regularPolygon({0, 0}, 1, 4, kPi / 4), 0};
        const auto irradiance = [&](double x, double y) { return opening.irradiance({x, y}, p_.distance); };
        Image image(film.cropWidth, film.cropHeight);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const auto [x0, x1, y0, y1] = view_.pixel(film, x, y);
                const double area = (x1 - x0) * (y1 - y0);
                const double mean = integrate(irradiance, x0, x1, y0, y1, 1e-6 * area, p_.distance) / area;
                image.at(x, y) = Rgb(float(p_.reflectance / kPi * radiance_ * mean));
            }
        return image;
    }

private:
    Parameters p_;
    ReceiverView view_;
    double radiance_;
};

ULAM_REGISTER_GENERATOR(ParallelPlates, "parallel_plates", "two squares face to face: the image is known");

}  // namespace
}  // namespace ulam
