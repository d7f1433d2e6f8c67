#include "core/path/scattering.h"

#include "core/path/local_bsdf.h"

namespace ulam {
namespace {

/// f_s |n_s·w| = f̂_s |n_g·w| with w towards the light (Veach 1997, §5.3.2): f̂_s is what the three-point form with
/// geometric cosines needs, in either direction of transport.
inline double shadingCorrection(const Vertex& v, const Vec3f& toLight) {
    if (v.shadingNormal == v.normal) return 1;
    const float g = std::abs(dot(v.normal, toLight));
    return g > 0 ? std::abs(dot(v.shadingNormal, toLight)) / double(g) : 0;
}

/// None where a factor is not finite.
inline Scattering checked(const Scattering& s) {
    return checkFinite(Cause::BsdfValue, s.f.x + s.f.y + s.f.z + s.pdfToCamera + s.pdfToLight) ? s : Scattering::none();
}

}  // namespace

Scattering scatter(const Scene& scene, const Vertex& v, Lobe lobe, const Vec3f& toLight, const Vec3f& toCamera) {
    return withBsdf(scene, v, dot(v.shadingNormal, toLight), [&](const auto& bsdf, const LocalFrame& frame) -> Scattering {
        const Imath::V3d l(frame.toLocal(toLight)), c(frame.toLocal(toCamera));
        const Spectrum f = bsdf.eval(l, c, lobe);
        if (isBlack(f)) return Scattering::none();
        return checked({f * shadingCorrection(v, toLight), bsdf.pdf(l, c, lobe), bsdf.pdf(c, l, lobe)});
    });
}

bool sampleScattering(const Scene& scene, Vertex& v, const Vec3f& from, From walk, const Block& u, ScatteredDirection& out,
                      std::optional<Lobe> lobe) {
    return withBsdf(scene, v, dot(v.shadingNormal, from), [&](const auto& bsdf, const LocalFrame& frame) {
        const Vec3f known = frame.toLocal(from);
        const auto sampled = lobe ? bsdf.sampleLobe(known, *lobe, u) : bsdf.sample(known, u);
        if (!sampled) return false;
        v.lobe = sampled->lobe;
        const Imath::V3d dk(known), dt(sampled->to);
        const auto& l = walk == From::Light ? dk : dt;
        const auto& c = walk == From::Light ? dt : dk;
        const Spectrum f = bsdf.eval(l, c, v.lobe);
        out.direction = frame.toWorld(sampled->to);
        if (!checkFinite(Cause::BsdfValue, out.direction.x + out.direction.y + out.direction.z) || isBlack(f)) return false;
        const Vec3f& toLight = walk == From::Light ? from : out.direction;
        out.scattering = checked({f * shadingCorrection(v, toLight), bsdf.pdf(l, c, v.lobe), bsdf.pdf(c, l, v.lobe)});
        return !isBlack(out.scattering.f);
    });
}

double lobeProbability(const Scene& scene, const Vertex& v, const Vec3f& from, const Vec3f& to) {
    return withBsdf(scene, v, dot(v.shadingNormal, from), [&](const auto& bsdf, const LocalFrame& frame) {
        return bsdf.probability(Imath::V3d(frame.toLocal(from)), Imath::V3d(frame.toLocal(to)), v.lobe);
    });
}

double smoothShare(const Scene& scene, const Vertex& v, const Vec3f& from) {
    return withBsdf(scene, v, dot(v.shadingNormal, from),
                    [&](const auto& bsdf, const LocalFrame& frame) { return smoothShareOf(bsdf, frame.toLocal(from)); });
}

bool invertScattering(const Scene& scene, const Vertex& v, const Vec3f& from, const Vec3f& to, Block& u) {
    return withBsdf(scene, v, dot(v.shadingNormal, from), [&](const auto& bsdf, const LocalFrame& frame) {
        return bsdf.invert(frame.toLocal(from), frame.toLocal(to), v.lobe, u);
    });
}

double albedoAt(const Scene& scene, const Vertex& v) {
    const Material& m = scene.materialAt(v);
    const auto albedo = [&](const Coating& coating) {
        const double value = withCoating(scene, v, coating, [](const auto& bsdf) { return bsdf.albedo(); });
        return checkFinite(Cause::BsdfValue, value) ? value : 0;
    };
    return m.back ? std::max(albedo(m.front), albedo(*m.back)) : albedo(m.front);
}

}  // namespace ulam
