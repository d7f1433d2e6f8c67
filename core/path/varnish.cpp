#include "core/path/varnish.h"

#include "core/path/local_bsdf.h"
#include "core/scene/bsdfs/mixture.h"

namespace ulam {

VarnishAt::VarnishAt(const Scene& scene, const Vertex& v, const Varnish& varnish)
    : scene_(scene), v_(v), varnish_(varnish) {
    nestedAlbedo_ = nested([](const auto& bsdf) { return bsdf.albedo(); });
}

double VarnishAt::smoothShare(const Vec3f& from) const {
    if (!(from.z > 0)) return 0;
    const double share = coatShare(double(from.z));
    const double below = nested([&](const auto& bsdf) { return smoothShareOf(bsdf, inside(from)); });
    return (varnish_.rough ? share : 0) + (1 - share) * below;
}

double VarnishAt::coatBegin(const Vec3f& from, double share) const {
    if (!varnish_.rough) return 0;
    return (1 - share) * (1 - nested([&](const auto& bsdf) { return smoothShareOf(bsdf, inside(from)); }));
}

std::optional<ScatterSample> VarnishAt::reflect(const Vec3f& from, const Block& u) const {
    if (!varnish_.rough) return ScatterSample{reflected(from), Lobe::DeltaReflection};
    const Vec3d w(from);
    const Vec3f to(mirroredAt(w, varnish_.rough->distribution.sampleVisible(w, u[0], u[1])));
    if (!(to.z > 0)) return std::nullopt;
    return ScatterSample{to, Lobe::Smooth};
}

std::optional<ScatterSample> VarnishAt::outside(std::optional<ScatterSample> sample) const {
    if (!sample) return std::nullopt;
    const Vec3d w(sample->to);
    const double cos2 = 1 - (1 - w.z * w.z) * ior() * ior();
    if (!(cos2 > 0 && w.z > 0)) return std::nullopt;  // total internal reflection
    sample->to = Vec3f(Vec3d(w.x * ior(), w.y * ior(), std::sqrt(cos2))).normalized();
    return sample;
}

std::optional<ScatterSample> VarnishAt::sampleLobe(const Vec3f& from, Lobe lobe, Block u) const {
    if (!(from.z > 0)) return std::nullopt;
    const double share = coatShare(double(from.z));
    if (lobe == coatLobe()) {
        const double below =
            nested([&](const auto& bsdf) { return isDelta(lobe) ? 0 : smoothShareOf(bsdf, inside(from)); });
        const auto chosen = choosePart(std::array{share, (1 - share) * below}, u[2]);
        if (!chosen) return std::nullopt;
        if (chosen->index == 0) return reflect(from, u);
        u[2] = chosen->within;
    }
    return outside(nested([&](const auto& bsdf) { return bsdf.sampleLobe(inside(from), lobe, u); }));
}

std::optional<ScatterSample> VarnishAt::sample(const Vec3f& from, Block u) const {
    if (!(from.z > 0)) return std::nullopt;
    const double share = coatShare(double(from.z)), begin = coatBegin(from, share);
    if (u[2] >= begin && u[2] < begin + share) return reflect(from, u);
    u[2] = (u[2] < begin ? u[2] : u[2] - share) / (1 - share);
    return outside(nested([&](const auto& bsdf) { return bsdf.sample(inside(from), u); }));
}

bool VarnishAt::invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
    if (!(from.z > 0 && to.z > 0)) return false;
    const Vec3d w(from), t(to);
    const double share = coatShare(w.z), begin = coatBegin(from, share);
    const auto chosen =
        choosePart(std::array{share * reflectionPdf(w, t, lobe), (1 - share) * nestedPdf(w, t, lobe)}, u[2]);
    if (!chosen) return false;
    u[2] = chosen->within;
    if (chosen->index == 0) {
        if (varnish_.rough) {
            const Sample2 s = varnish_.rough->distribution.invertVisible(w, HalfVector<double>(w + t).m);
            u[0] = s.u;
            u[1] = s.v;
        }
        u[2] = begin + u[2] * share;
        return true;
    }
    if (!nested([&](const auto& bsdf) { return bsdf.invert(inside(from), inside(to), lobe, u); })) return false;
    u[2] *= 1 - share;
    // Delta lobes of what is nested come before the coat's part.
    if (!(isDelta(lobe) && varnish_.rough)) u[2] += share;
    return true;
}

}  // namespace ulam
