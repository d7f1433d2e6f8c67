#pragma once
// bitmap: a picture over the surface's parameters (Mitsuba 3 `bitmap`). Row 0 lies at v = 0; texel centres are at
// ((i + ½) / width, (j + ½) / height).

#include "core/image/packed_image.h"

#include <array>
#include <memory>
#include <string>

namespace ulam {

/// An affine map of the plane: (u, v) ↦ (m[0] u + m[1] v + m[2], m[3] u + m[4] v + m[5]).
struct UvTransform {
    std::array<double, 6> m{1, 0, 0, 0, 1, 0};
    Vec2f operator()(const Vec2f& uv) const {
        return {float(m[0] * uv.x + m[1] * uv.y + m[2]), float(m[3] * uv.x + m[4] * uv.y + m[5])};
    }
};

class BitmapTexture {
public:
    struct Parameters {
        std::string filterType = "bilinear", wrapMode = "repeat";
        bool raw = false;
        template <class V>
        void describe(V& v) {
            v("filter_type", filterType, {.help = "between texels", .choices = {"bilinear", "nearest"}});
            v("wrap_mode", wrapMode, {.help = "outside [0,1]", .choices = {"repeat", "mirror", "clamp"}});
            v("raw", raw, {.help = "take integer formats as they are, not as sRGB: for roughness and other data"});
        }
    };

    BitmapTexture(const Parameters& p, const UvTransform& toUv, const Image& image)
        : image_(std::make_shared<const PackedImage>(image)),
          toUv_(toUv),
          wrap_(p.wrapMode == "repeat" ? Wrap::Repeat : p.wrapMode == "mirror" ? Wrap::Mirror : Wrap::Clamp),
          nearest_(p.filterType == "nearest") {}

    Spectrum color(const Vec2f& surface) const {
        const Vec2f uv = toUv_(surface);
        const double x = double(uv.x) * image_->width(), y = double(uv.y) * image_->height();
        if (nearest_) return Spectrum(texel(std::floor(x), std::floor(y)));
        const double x0 = std::floor(x - 0.5), y0 = std::floor(y - 0.5), fx = x - 0.5 - x0, fy = y - 0.5 - y0;
        return (Spectrum(texel(x0, y0)) * (1 - fx) + Spectrum(texel(x0 + 1, y0)) * fx) * (1 - fy) +
               (Spectrum(texel(x0, y0 + 1)) * (1 - fx) + Spectrum(texel(x0 + 1, y0 + 1)) * fx) * fy;
    }
    double value(const Vec2f& surface) const { return luminance(color(surface)); }
    /// ∂value/∂u and ∂value/∂v; 0 where texels are taken without interpolation.
    Vec2f slope(const Vec2f& surface) const {
        if (nearest_) return {0, 0};
        const Vec2f uv = toUv_(surface);
        const double x = double(uv.x) * image_->width(), y = double(uv.y) * image_->height();
        const double x0 = std::floor(x - 0.5), y0 = std::floor(y - 0.5), fx = x - 0.5 - x0, fy = y - 0.5 - y0;
        const auto height = [&](double i, double j) { return luminance(Spectrum(texel(x0 + i, y0 + j))); };
        const double a = height(0, 0), b = height(1, 0), c = height(0, 1), d = height(1, 1);
        const double alongX = ((b - a) * (1 - fy) + (d - c) * fy) * image_->width();
        const double alongY = ((c - a) * (1 - fx) + (d - b) * fx) * image_->height();
        const auto& m = toUv_.m;
        return {float(alongX * m[0] + alongY * m[3]), float(alongX * m[1] + alongY * m[4])};
    }

    size_t bytes() const { return image_->bytes(); }
    Rgb smallest() const { return extreme([](float a, float b) { return std::min(a, b); }); }
    Rgb largest() const { return extreme([](float a, float b) { return std::max(a, b); }); }

private:
    enum class Wrap : uint8_t { Repeat, Mirror, Clamp };

    template <class Choose>
    Rgb extreme(Choose choose) const {
        Rgb result = image_->at(0, 0);
        for (int y = 0; y < image_->height(); ++y)
            for (int x = 0; x < image_->width(); ++x)
                for (int c = 0; c < 3; ++c) result[c] = choose(result[c], image_->at(x, y)[c]);
        return result;
    }

    int wrapped(double i, int size) const {
        if (wrap_ == Wrap::Clamp) return int(std::clamp(i, 0.0, size - 1.0));
        const double period = wrap_ == Wrap::Repeat ? size : 2.0 * size;
        const int k = std::clamp(int(i - period * std::floor(i / period)), 0, int(period) - 1);
        return k < size ? k : 2 * size - 1 - k;
    }
    Rgb texel(double x, double y) const { return image_->at(wrapped(x, image_->width()), wrapped(y, image_->height())); }

    std::shared_ptr<const PackedImage> image_;
    UvTransform toUv_;
    Wrap wrap_;
    bool nearest_;
};

}  // namespace ulam
