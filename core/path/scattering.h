#pragma once
// The BSDFs as paths see them: light flows from the light's side to the camera's side, whichever way a walk goes.

#include "core/base/non_finite.h"
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
    template <class Archive>
    void archive(Archive& a) {
        a(f, pdfToCamera, pdfToLight);
    }
    double pdf(From walk) const { return walk == From::Light ? pdfToCamera : pdfToLight; }
    double reversePdf(From walk) const { return walk == From::Light ? pdfToLight : pdfToCamera; }
};

/// Scattering at v by a given lobe; both directions point away from v.
Scattering scatter(const Scene& scene, const Vertex& v, Lobe lobe, const Vec3f& toLight, const Vec3f& toCamera);

struct ScatteredDirection {
    Vec3f direction;
    Scattering scattering;
};

/// Samples the next direction of a walk that arrived along `from` (pointing back), and marks the lobe on the vertex. With
/// `lobe` given, that lobe is taken instead of a random one.
bool sampleScattering(const Scene& scene, Vertex& v, const Vec3f& from, From walk, const Block& u, ScatteredDirection& out,
                      std::optional<Lobe> lobe = std::nullopt);

/// Probability that a walk which arrived along `from` and left along `to` chose the lobe marked on v.
double lobeProbability(const Scene& scene, const Vertex& v, const Vec3f& from, const Vec3f& to);

/// Probability that a walk which arrived along `from` chooses the smooth lobe.
double smoothShare(const Scene& scene, const Vertex& v, const Vec3f& from);

/// The numbers that make sampleScattering() at v choose `to`; those that do not matter stay as they are, and where several
/// numbers do, the ones given here choose among them.
bool invertScattering(const Scene& scene, const Vertex& v, const Vec3f& from, const Vec3f& to, Block& u);

/// Albedo of the surface at v, for Russian roulette.
double albedoAt(const Scene& scene, const Vertex& v);

// The two ends of a path: what a walk needs to leave them, and what a connection to them carries.

/// L_e from x_0 along w (intensity for a point), and the density of w for a walk from there.
struct Emission {
    Spectrum radiance{0.0};
    double pdf = 0;
};
inline Emission emission(const Scene& scene, const Vertex& x0, const Vec3f& w) {
    const uint32_t e = scene.emitterAt(x0);
    if (e == kNone) return {};
    const Emission emitted = dispatch(scene.emitters[e], [&](const auto& emitter) -> Emission {
        const EmissionContext c = scene.emission(e);
        return {emitter.radiance(c, x0, w), emitter.directionPdf(c, x0, w)};
    });
    const Spectrum& l = emitted.radiance;
    return checkFinite(Cause::Light, l.x + l.y + l.z + emitted.pdf) ? emitted : Emission{};
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
    const double pdf = scene.emitterChoice().probability(e) *
                       dispatch(scene.emitters[e], [&](const auto& emitter) { return emitter.directPdf(scene.emission(e), x1, x0); });
    return checkFinite(Cause::Light, pdf) ? pdf : 0;
}

}  // namespace ulam
