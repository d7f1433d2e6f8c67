#include "core/path/reference_factors.h"

#include "core/path/local_bsdf.h"
#include "core/path/reference_bsdfs.h"

#include <limits>

namespace ulam {
namespace {

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

/// What a tilt of the half vector does to a narrow distribution: evaluates at the corners of the box of errors towards which
/// each factor grows and falls.
template <class B>
void extendByTilt(FactorRanges& ranges, const B& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c) {
    using Shift = std::array<double, 6>;
    const auto shifted = [&](const Shift& s) {
        return factorsOf(bsdf, lobe, l + Vec3d(s[0], s[1], s[2]), c + Vec3d(s[3], s[4], s[5]));
    };
    std::array<Shift, 5> corners;
    for (size_t i = 0; i < 6; ++i) {
        Shift up{}, down{};
        up[i] = kCosineError;
        down[i] = -kCosineError;
        const Factors high = shifted(up), low = shifted(down);
        for (size_t j = 0; j < 5; ++j) corners[j][i] = high[j] > low[j] ? kCosineError : -kCosineError;
    }
    for (Shift& corner : corners) {
        extend(ranges, shifted(corner));
        for (double& s : corner) s = -s;
        extend(ranges, shifted(corner));
    }
}
template <class B, class... Others>
constexpr bool kIsOneOf = (std::is_same_v<B, Others> || ...);
template <class B>
constexpr bool kMayBeNarrow = kIsOneOf<B, RoughConductor, RoughDielectric, RoughPlastic, Phong, Ward, Principled, MixtureAt, ReliefAt, VarnishAt>;

/// Around the shading normal, x along the tangent where the BSDF asks for it.
template <class B>
Vec3d localDirection(const Scene& scene, const Vertex& v, const B& bsdf, const Vec3d& w) {
    const Vec3d z = inDouble(v.shadingNormal);
    Vec3d along = std::abs(z.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    if constexpr (requires { bsdf.anisotropic(); })
        if (bsdf.anisotropic()) along = inDouble(scene.shapes[v.shape].tangent(v));
    const Vec3d x = (along - z * z.dot(along)).normalized();
    return {x.dot(w), z.cross(x).dot(w), z.dot(w)};
}

/// How far two directions miss the law of a delta lobe.
template <class B>
double lawError(const B& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c) {
    if (lobe == Lobe::Smooth) return 0;
    if (!B::hasDelta) return std::numeric_limits<double>::infinity();
    if (lobe == Lobe::Null) return (l + c).length();
    if (lobe == Lobe::DeltaReflection) return (Vec3d(-l.x, -l.y, l.z) - c).length();
    if constexpr (std::is_same_v<B, Dielectric>) {
        const double nLight = l.z > 0 ? 1 : bsdf.ior, nCamera = c.z > 0 ? 1 : bsdf.ior;
        return std::hypot(l.x * nLight + c.x * nCamera, l.y * nLight + c.y * nCamera);
    }
    return std::numeric_limits<double>::infinity();
}
double lawError(const MixtureAt& mixture, Lobe lobe, const Vec3d& l, const Vec3d& c);
double lawError(const ReliefAt& relief, Lobe lobe, const Vec3d& l, const Vec3d& c) {
    return relief.nested([&](const auto& bsdf) { return lawError(bsdf, lobe, relief.turned(l), relief.turned(c)); });
}
double lawError(const MixtureAt& mixture, Lobe lobe, const Vec3d& l, const Vec3d& c) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < mixture.size(); ++i)
        least = std::min(least, mixture.part(i, [&](const auto& bsdf) { return lawError(bsdf, lobe, l, c); }));
    return least;
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
    const double cosLight = inDouble(v.shadingNormal).dot(toLight), geometric = exactCosine(v, toLight);
    FactorRanges ranges = emptyRanges();
    for (const double errorLight : {-kCosineError, 0.0, kCosineError}) {
        const double cosine = cosLight + errorLight, side = scene.materialAt(v).back && !(cosine > 0) ? -1 : 1;
        withBsdf(scene, v, float(cosine), [&]<class B>(const B& bsdf, const LocalFrame&) {
            const Vec3d l = localDirection(scene, v, bsdf, toLight), c = localDirection(scene, v, bsdf, toCamera);
            const Vec3d sideLight(l.x, l.y, side * (l.z + errorLight));
            for (const double errorCamera : {-kCosineError, 0.0, kCosineError})
                extend(ranges, factorsOf(bsdf, v.lobe, sideLight, Vec3d(c.x, c.y, side * (c.z + errorCamera))));
            if constexpr (kMayBeNarrow<B>)
                if (errorLight == 0) extendByTilt(ranges, bsdf, v.lobe, sideLight, Vec3d(c.x, c.y, side * c.z));
        });
    }
    // Light along the surface that meets a relief's slope: f may be as large as the cosine is small.
    if (std::abs(cosLight) <= kCosineError)
        forEachLayer(scene.materialAt(v).front, [&](const Coating& layer) {
            if (!std::holds_alternative<Relief>(layer.layer)) return;
            for (size_t i = 0; i < 3; ++i) ranges[i] = {0, std::numeric_limits<double>::max()};
        });
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
    return withBsdf(scene, v, float(inDouble(v.shadingNormal).dot(toLight)), [&]<class B>(const B& bsdf, const LocalFrame&) {
        return lawError(bsdf, v.lobe, localDirection(scene, v, bsdf, toLight), localDirection(scene, v, bsdf, toCamera));
    });
}

}  // namespace ulam
