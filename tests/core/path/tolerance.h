#pragma once
// What float geometry explains. A walk's ray starts `offset` away from its vertex, so the direction between the
// positions of two vertices differs from the sampled one by about offset / length: densities of directions then differ
// by that over the cosine, and probabilities of reflection by more near the critical angle.

#include <limits>

#include "core/path/factors.h"
#include "core/path/reference_factors.h"

namespace ulam {

inline double shadingCosine(const Vertex& v, const Vec3f& w) {
    return v.hasNormal() ? std::abs(double(dot(v.shadingNormal, w))) : 1;
}

/// Does the smooth lobe change within a degree? That of Diffuse does not.
inline bool isGlossy(const Material& m) {
    bool glossy = false;
    for (const Coating* side : {&m.front, m.back ? &*m.back : &m.front})
        forEachLayer(*side, [&](const Coating& coating) {
            const auto* plain = std::get_if<TexturedBsdf>(&coating.layer);
            glossy |= m.hasSmooth && !(plain && std::holds_alternative<Diffuse>(plain->bsdf));
        });
    return glossy;
}

/// How far log densities and log f of a path may be from each other, walked and recomputed.
inline double explainedLogError(const Tracing& tracing, const Path& path, const PathFactors& factors) {
    double sum = 1e-6;
    std::array<double, kMaxVertices> angle;
    for (int i = 0; i < path.length(); ++i) {
        const Edge& e = factors.edge[size_t(i)];
        const bool endless = path[i].atInfinity();
        angle[size_t(i)] = tracing.offsetLength() * (endless ? 0 : std::sqrt(e.inverseD2)) + 4e-7;
        for (const double c :
             {e.cosA, e.cosB, shadingCosine(path[i], e.direction), shadingCosine(path[i + 1], e.direction)})
            sum += angle[size_t(i)] / c;
    }
    const auto explain = [&](const FactorRanges& ranges, double error) {
        // The range that the reference finds for a cosine error of kCosineError, taken to the actual one.
        const double scale = std::max(1.0, error / kCosineError);
        std::array<double, 5> log;
        // Below 1e-290 a number loses its digits, and then itself.
        for (size_t i = 0; i < 5; ++i)
            log[i] = ranges[i].high > 1e-290   ? scale * std::log(ranges[i].high / std::max(ranges[i].low, 1e-300))
                     : ranges[i].high > 0 ? std::numeric_limits<double>::infinity()
                                          : 0;
        // A contribution holds one colour of f and one of the densities.
        sum += std::max({log[0], log[1], log[2]}) + std::max(log[3], log[4]);
    };
    explain(emissionReference(tracing.scene(), path[0], exactDirection(path[0], path[1])), angle[0]);
    for (int i = 1; i < path.length(); ++i) {
        if (!isDelta(path[i].lobe) && !isGlossy(tracing.scene().materialAt(path[i]))) continue;
        explain(scatteringReference(tracing.scene(), path[i], exactDirection(path[i], path[i - 1]), exactDirection(path[i], path[i + 1])),
                angle[size_t(i - 1)] + angle[size_t(i)]);
    }
    // Relative errors, at worst all on one side.
    return sum < 1 ? -std::log1p(-sum) : std::numeric_limits<double>::infinity();
}

}  // namespace ulam
