#include "core/path/reference_factors.h"

#include "core/path/local_bsdf.h"

#include <complex>
#include <limits>

namespace ulam {
namespace {

using Factors = std::array<double, 5>;

/// Amplitude coefficients squared and averaged, from the indices and cosines on either side (Born & Wolf §1.5.2).
double fresnelReflectance(std::complex<double> n1, double cos1, std::complex<double> n2, std::complex<double> cos2) {
    const auto s = (n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2);
    const auto p = (n2 * cos1 - n1 * cos2) / (n2 * cos1 + n1 * cos2);
    return (std::norm(s) + std::norm(p)) / 2;
}

/// Dielectric, from the ray in index n1; the complex root covers total reflection.
double fresnelReflectance(double n1, double cos1, double n2) {
    const double sin2 = (1 - cos1 * cos1) * (n1 * n1) / (n2 * n2);
    return fresnelReflectance(n1, cos1, n2, std::sqrt(std::complex<double>(1 - sin2)));
}

/// Conductor of index eta + i k, seen from vacuum. With q = ñ cosθ_t the formula also holds for ñ = 0.
double conductorReflectance(double cosTheta, double eta, double k) {
    const std::complex<double> n2 = std::complex<double>(eta, k) * std::complex<double>(eta, k);
    const std::complex<double> q = std::sqrt(n2 - (1 - cosTheta * cosTheta));
    const auto s = (cosTheta - q) / (cosTheta + q), p = (n2 * cosTheta - q) / (n2 * cosTheta + q);
    return (std::norm(s) + std::norm(p)) / 2;
}

// One function a BSDF: f_s and the densities from the lobe and the signed cosines with the shading normal.

Factors factorsOf(const Diffuse& bsdf, Lobe lobe, double cosLight, double cosCamera) {
    if (lobe != Lobe::Smooth || cosLight <= 0 || cosCamera <= 0) return {};
    const Spectrum& r = bsdf.reflectance;
    return {r.x / kPi, r.y / kPi, r.z / kPi, cosCamera / kPi, cosLight / kPi};
}

Factors factorsOf(const Conductor& bsdf, Lobe lobe, double cosLight, double cosCamera) {
    if (lobe != Lobe::DeltaReflection || cosLight <= 0 || cosCamera <= 0) return {};
    Factors out;
    for (int c = 0; c < 3; ++c)
        out[size_t(c)] = bsdf.specularReflectance[c] * conductorReflectance(cosLight, bsdf.eta[c], bsdf.k[c]);
    out[3] = cosCamera;
    out[4] = cosLight;
    return out;
}

Factors factorsOf(const Dielectric& bsdf, Lobe lobe, double cosLight, double cosCamera) {
    const double nLight = cosLight > 0 ? 1 : bsdf.ior, nCamera = cosCamera > 0 ? 1 : bsdf.ior;
    const bool sameSide = (cosLight > 0) == (cosCamera > 0);
    if (lobe == Lobe::Smooth || sameSide != (lobe == Lobe::DeltaReflection)) return {};
    const double a = std::abs(cosLight), b = std::abs(cosCamera);
    // The two rays obey the lobe's law up to rounding. Reflection: their mean. Refraction: the ray on the thin side,
    // which says more about the angles than the other.
    double r;
    if (sameSide)
        r = fresnelReflectance(nLight, (a + b) / 2, nLight == 1 ? bsdf.ior : 1);
    else
        r = nLight < nCamera ? fresnelReflectance(nLight, a, nCamera) : fresnelReflectance(nCamera, b, nLight);
    const double chosen = sameSide ? r : 1 - r;
    const Spectrum& tint = sameSide ? bsdf.specularReflectance : bsdf.specularTransmittance;
    const double f = chosen * nCamera * nCamera;
    return {tint.x * f, tint.y * f, tint.z * f, chosen * b * nCamera * nCamera, chosen * a * nLight * nLight};
}

template <class B>
Factors factorsOf(const Masked<B>& bsdf, Lobe lobe, double cosLight, double cosCamera) {
    Factors out = factorsOf(bsdf.nested, lobe, cosLight, cosCamera);
    for (double& x : out) x *= bsdf.opacity;
    if (lobe != Lobe::Null || (cosLight > 0) == (cosCamera > 0)) return out;
    const double passed = 1 - bsdf.opacity;
    for (size_t c = 0; c < 3; ++c) out[c] += passed;
    out[3] += passed * std::abs(cosCamera);
    out[4] += passed * std::abs(cosLight);
    return out;
}

void extend(FactorRanges& ranges, const Factors& factors) {
    for (size_t i = 0; i < 5; ++i) {
        ranges[i].low = std::min(ranges[i].low, factors[i]);
        ranges[i].high = std::max(ranges[i].high, factors[i]);
    }
}

FactorRanges emptyRanges() {
    FactorRanges ranges;
    ranges.fill({std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
    return ranges;
}

FactorRanges exactly(const Spectrum& f, double toCamera, double toLight) {
    FactorRanges ranges = emptyRanges();
    extend(ranges, {f.x, f.y, f.z, toCamera, toLight});
    return ranges;
}

FactorRanges emissionOf(const AreaEmitter& emitter, const Scene& scene, const Vertex& x0, const Vec3d& w) {
    const Spectrum radiance =
        emitter.texture == kNone ? emitter.emitted : textureColor(scene.textures[emitter.texture], scene.shapes[x0.shape].texcoord(x0));
    FactorRanges ranges = emptyRanges();
    const double c = inDouble(x0.normal).dot(w);
    for (const double cosine : {c - kCosineError, c + kCosineError}) {
        const Spectrum l = cosine > 0 ? radiance : Spectrum(0.0);
        extend(ranges, {l.x, l.y, l.z, std::max(0.0, cosine) / kPi, 0});
    }
    return ranges;
}

FactorRanges emissionOf(const PointEmitter& emitter, const Scene&, const Vertex&, const Vec3d&) {
    return exactly(emitter.intensity, 1 / (4 * kPi), 0);
}

FactorRanges emissionOf(const SpotEmitter& emitter, const Scene&, const Vertex&, const Vec3d& w) {
    const double cone = 1 / (2 * kPi * (1 - std::cos(emitter.cutoff)));
    const Vec3d axis = inDouble(emitter.frame.n);
    const double theta = std::atan2(axis.cross(w).length(), axis.dot(w));
    FactorRanges ranges = emptyRanges();
    for (const double t : {theta - 2 * kCosineError, theta + 2 * kCosineError}) {
        const double share = t >= emitter.cutoff ? 0 : t <= emitter.beam ? 1 : (emitter.cutoff - t) / (emitter.cutoff - emitter.beam);
        const Spectrum f = emitter.intensity * share;
        extend(ranges, {f.x, f.y, f.z, t < emitter.cutoff ? cone : 0, 0});
    }
    return ranges;
}

/// 1 / area of the scene's disc.
double perDisc(const Scene& scene) { return 1 / (kPi * double(scene.bounds().radius) * scene.bounds().radius); }

FactorRanges emissionOf(const ConstantEmitter& emitter, const Scene& scene, const Vertex&, const Vec3d&) {
    return exactly(emitter.emitted, perDisc(scene), 0);
}

FactorRanges emissionOf(const DirectionalEmitter& emitter, const Scene& scene, const Vertex&, const Vec3d&) {
    return exactly(emitter.irradiance, perDisc(scene), 0);
}

FactorRanges emissionOf(const EnvmapEmitter& emitter, const Scene& scene, const Vertex& x0, const Vec3d&) {
    return exactly(emitter.map->radiance(x0.position), perDisc(scene), 0);
}

}  // namespace

Vec3d exactDirection(const Vertex& a, const Vertex& b) {
    if (b.atInfinity()) return inDouble(b.position).normalized();
    if (a.atInfinity()) return -inDouble(a.position).normalized();
    return (inDouble(b.position) - inDouble(a.position)).normalized();
}

double exactInverseD2(const Vertex& a, const Vertex& b) {
    if (a.atInfinity() || b.atInfinity()) return 1;
    return 1 / (inDouble(b.position) - inDouble(a.position)).length2();
}

double exactCosine(const Vertex& v, const Vec3d& w) {
    return v.hasNormal() ? std::abs(inDouble(v.normal).dot(w)) : 1;
}

FactorRanges scatteringReference(const Scene& scene, const Vertex& v, const Vec3d& toLight, const Vec3d& toCamera) {
    const Vec3d n = inDouble(v.shadingNormal);
    const double cosLight = n.dot(toLight), cosCamera = n.dot(toCamera), geometric = exactCosine(v, toLight);
    FactorRanges ranges = emptyRanges();
    for (const double l : {cosLight - kCosineError, cosLight, cosLight + kCosineError})
        for (const double c : {cosCamera - kCosineError, cosCamera, cosCamera + kCosineError}) {
            const double side = scene.materialAt(v).back && !(l > 0) ? -1 : 1;
            extend(ranges, withBsdf(scene, v, float(l), [&](const auto& bsdf, const LocalFrame&) { return factorsOf(bsdf, v.lobe, side * l, side * c); }));
        }
    // f_s |n_s·w| = f̂_s |n_g·w| with w towards the light (Veach 1997, §5.3.2). The same normals give exactly 1.
    if (v.shadingNormal == v.normal) return ranges;
    const double low = std::max(0.0, std::abs(cosLight) - kCosineError) / (geometric + kCosineError);
    const double high = (std::abs(cosLight) + kCosineError) / std::max(1e-30, geometric - kCosineError);
    for (size_t i = 0; i < 3; ++i) ranges[i] = {ranges[i].low * low, ranges[i].high * high};
    return ranges;
}

FactorRanges emissionReference(const Scene& scene, const Vertex& x0, const Vec3d& w) {
    return std::visit([&](const auto& emitter) { return emissionOf(emitter, scene, x0, w); },
                      scene.emitters[scene.emitterAt(x0)]);
}

FactorRanges importanceReference(const Scene& scene, const Vertex& lens, const Vec3d& w) {
    // The raster is an affine picture of a plane. So the directions of the window's corners, at suitable distances, are
    // the corners of a parallelogram; four vectors in space determine those distances up to a common factor.
    const auto& window = scene.sensor->window();
    const auto direction = [&](float x, float y) { return inDouble(scene.sensor->direction(lens, {x, y})); };
    const Vec3d d[4] = {direction(window.min.x, window.min.y), direction(window.max.x, window.min.y),
                        direction(window.max.x, window.max.y), direction(window.min.x, window.max.y)};
    Vec3d corner[4];
    for (int i = 0; i < 4; ++i) corner[i] = d[i] * std::abs(d[(i + 1) % 4].dot(d[(i + 2) % 4].cross(d[(i + 3) % 4])));
    const Vec3d area = (corner[1] - corner[0]).cross(corner[3] - corner[0]);
    const Vec3d axis = area.normalized() * (area.dot(corner[0]) > 0 ? 1 : -1);
    // A point uniform on the parallelogram, seen from the aperture.
    const double distance = axis.dot(corner[0]), c = axis.dot(w);
    const double density = c > 0 ? distance * distance / (area.length() * c * c * c) : 0;
    if (lens.kind == Vertex::Kind::Point) return exactly(Spectrum(density), 0, density);
    // ∫ W_e |cosθ| dω dA = 1, all points of the aperture alike.
    const double radius = scene.sensor->apertureRadius();
    return exactly(Spectrum(density / (kPi * radius * radius * c)), 0, density);
}

double deltaLawError(const Scene& scene, const Vertex& v, const Vec3d& toLight, const Vec3d& toCamera) {
    const Vec3d n = inDouble(v.shadingNormal);
    const double cosLight = n.dot(toLight), cosCamera = n.dot(toCamera);
    if (v.lobe == Lobe::DeltaReflection) return (n * (2 * cosLight) - toLight - toCamera).length();
    if (v.lobe == Lobe::Smooth) return 0;
    if (v.lobe == Lobe::Null) return (toLight + toCamera).length();
    const auto* glass = std::get_if<Dielectric>(&scene.materialAt(v).front.bsdf);
    if (!glass) return std::numeric_limits<double>::infinity();
    const double nLight = cosLight > 0 ? 1 : glass->ior, nCamera = cosCamera > 0 ? 1 : glass->ior;
    return ((toLight - n * cosLight) * nLight + (toCamera - n * cosCamera) * nCamera).length();
}

}  // namespace ulam
