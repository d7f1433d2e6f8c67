#pragma once
// The BSDFs as paths see them: light flows from the light's side to the camera's side, whichever way a walk goes.

#include "core/path/measure.h"
#include "core/path/path.h"

namespace ulam {

/// Which end of the path a walk started from.
enum class From : uint8_t { Light, Camera };

/// Scattering at one vertex, both densities per solid angle (for a delta lobe: factors of δ_σ).
struct Scattering {
    Spectrum f;          ///< f_s(toLight → toCamera), corrected for shading normals
    double pdfToCamera;  ///< of toCamera, for a walk from the light
    double pdfToLight;   ///< of toLight, for a walk from the camera

    Scattering() {}  // left open: arrays of them are made often
    Scattering(const Spectrum& value, double toCamera, double toLight) : f(value), pdfToCamera(toCamera), pdfToLight(toLight) {}
    static Scattering none() { return {Spectrum(0.0), 0, 0}; }
    double pdf(From walk) const { return walk == From::Light ? pdfToCamera : pdfToLight; }
    double reversePdf(From walk) const { return walk == From::Light ? pdfToLight : pdfToCamera; }
};

/// f_s |n_s·w| = f̂_s |n_g·w| with w towards the light (Veach 1997, §5.3.2): f̂_s is what the three-point form with
/// geometric cosines needs, in either direction of transport.
inline double shadingCorrection(const Vertex& v, const Vec3f& toLight) {
    const float g = std::abs(dot(v.normal, toLight));
    return g > 0 ? std::abs(dot(v.shadingNormal, toLight)) / double(g) : 0;
}

/// Directions in the local frame of the shading normal at v, as the BSDF on their side sees them. Made only once the BSDF
/// is known: what a formula does not use of it is never computed.
class LocalFrame {
public:
    LocalFrame(const Vertex& v, bool mirrored) : frame_(v.shadingNormal), mirrored_(mirrored) {}
    Vec3f toLocal(const Vec3f& w) const { return mirror(frame_.toLocal(w)); }
    Vec3f toWorld(const Vec3f& w) const { return frame_.toWorld(mirror(w)); }

private:
    Vec3f mirror(const Vec3f& w) const { return {w.x, w.y, mirrored_ ? -w.z : w.z}; }

    Frame frame_;
    bool mirrored_;
};

/// Scattering at v by a given lobe; both directions point away from v.
inline Scattering scatter(const Scene& scene, const Vertex& v, Lobe lobe, const Vec3f& toLight, const Vec3f& toCamera) {
    return scene.materialAt(v).onSideOf(dot(v.shadingNormal, toLight), [&](const auto& bsdf, bool mirrored) -> Scattering {
        const LocalFrame frame(v, mirrored);
        const Imath::V3d l(frame.toLocal(toLight)), c(frame.toLocal(toCamera));
        const Spectrum f = bsdf.eval(l, c, lobe);
        if (isBlack(f)) return Scattering::none();
        return {f * shadingCorrection(v, toLight), bsdf.pdf(l, c, lobe), bsdf.pdf(c, l, lobe)};
    });
}

struct ScatteredDirection {
    Vec3f direction;
    Scattering scattering;
};

/// Samples the next direction of a walk that arrived along `from` (pointing back), and marks the lobe on the vertex. With
/// `lobe` given, that lobe is taken instead of a random one.
inline bool sampleScattering(const Scene& scene, Vertex& v, const Vec3f& from, From walk, const Block& u, ScatteredDirection& out,
                             std::optional<Lobe> lobe = std::nullopt) {
    return scene.materialAt(v).onSideOf(dot(v.shadingNormal, from), [&](const auto& bsdf, bool mirrored) {
        const LocalFrame frame(v, mirrored);
        const Vec3f known = frame.toLocal(from);
        const auto sampled = lobe ? bsdf.sampleLobe(known, *lobe, u) : bsdf.sample(known, u);
        if (!sampled) return false;
        v.lobe = sampled->lobe;
        const Imath::V3d dk(known), dt(sampled->to);
        const auto& l = walk == From::Light ? dk : dt;
        const auto& c = walk == From::Light ? dt : dk;
        const Spectrum f = bsdf.eval(l, c, v.lobe);
        if (isBlack(f)) return false;
        out.direction = frame.toWorld(sampled->to);
        const Vec3f& toLight = walk == From::Light ? from : out.direction;
        out.scattering = {f * shadingCorrection(v, toLight), bsdf.pdf(l, c, v.lobe), bsdf.pdf(c, l, v.lobe)};
        return true;
    });
}

/// Probability that a walk which arrived along `from` and left along `to` chose the lobe marked on v.
inline double lobeProbability(const Scene& scene, const Vertex& v, const Vec3f& from, const Vec3f& to) {
    return scene.materialAt(v).onSideOf(dot(v.shadingNormal, from), [&](const auto& bsdf, bool mirrored) {
        const LocalFrame frame(v, mirrored);
        return bsdf.probability(Imath::V3d(frame.toLocal(from)), Imath::V3d(frame.toLocal(to)), v.lobe);
    });
}

/// The numbers that make sampleScattering() at v choose `to`; those that do not matter stay as they are.
inline bool invertScattering(const Scene& scene, const Vertex& v, const Vec3f& from, const Vec3f& to, Block& u) {
    return scene.materialAt(v).onSideOf(dot(v.shadingNormal, from), [&](const auto& bsdf, bool mirrored) {
        const LocalFrame frame(v, mirrored);
        return bsdf.invert(frame.toLocal(from), frame.toLocal(to), v.lobe, u);
    });
}

/// Albedo of the surface at v, for Russian roulette.
inline double albedoAt(const Scene& scene, const Vertex& v) {
    const Material& m = scene.materialAt(v);
    auto albedo = [](const Bsdf& b) { return dispatch(b, [](const auto& bsdf) { return bsdf.albedo(); }); };
    return m.back ? std::max(albedo(m.front), albedo(*m.back)) : albedo(m.front);
}

// The two ends of a path: what a walk needs to leave them, and what a connection to them carries.

/// L_e from x_0 along w (intensity for a point), and the density of w for a walk from there.
struct Emission {
    Spectrum radiance{0.0};
    double pdf = 0;
};
inline Emission emission(const Scene& scene, const Vertex& x0, const Vec3f& w) {
    const uint32_t e = scene.emitterAt(x0);
    if (e == kNone) return {};
    return dispatch(scene.emitters[e], [&](const auto& emitter) -> Emission {
        const EmissionContext c = scene.emission(e);
        return {emitter.radiance(c, x0, w), emitter.directionPdf(c, x0, w)};
    });
}

/// Density of x_0 as the start of a walk: choice of the emitter times its density of positions.
inline double emissionPositionPdf(const Scene& scene, const Vertex& x0) {
    const uint32_t e = scene.emitterAt(x0);
    if (e == kNone) return 0;
    return scene.emitterChoice().probability(e) *
           dispatch(scene.emitters[e], [&](const auto& emitter) { return emitter.positionPdf(scene.emission(e), x0); });
}

/// Density of x_0 under next-event estimation from x_1.
inline double directLightPdf(const Scene& scene, const Vertex& x1, const Vertex& x0) {
    const uint32_t e = scene.emitterAt(x0);
    if (e == kNone) return 0;
    return scene.emitterChoice().probability(e) *
           dispatch(scene.emitters[e], [&](const auto& emitter) { return emitter.directPdf(scene.emission(e), x1, x0); });
}

}  // namespace ulam
