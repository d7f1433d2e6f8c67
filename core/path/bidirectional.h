#pragma once
// Bidirectional path tracing (Veach 1997, ch. 10) as a function from primary numbers to weighted contributions. It makes
// images, seeds chains and is the primary-space target.

#include "core/path/densities.h"

#include <optional>
#include <string>

namespace ulam {

struct BidirectionalOptions {
    PathLimits limits;
    TechniqueSet techniques;
    Heuristic heuristic = Heuristic::Balance;
};

/// The light that no technique of the set can carry in this scene, in words for the bias ledger; nothing if there is none.
std::optional<std::string> missedLight(const Scene& scene, const TechniqueSet& techniques);

/// One technique's part of a sample.
struct Contribution {
    Technique technique;
    Spectrum value;  ///< weight · f / p_{s,t}
    double weight;   ///< w_{s,t}
    Vec2f raster;    ///< the sample's own, for t ≥ 2
};

class BidirectionalSampler {
public:
    BidirectionalSampler(const Scene& scene, const BidirectionalOptions& options) : options_(options), tracing_(scene) {}

    Tracing& tracing() { return tracing_; }
    const Tracing& tracing() const { return tracing_; }
    const BidirectionalOptions& options() const { return options_; }

    /// Walks from both ends and hands every non-zero contribution to `visit(const Contribution&)`. During the call
    /// join() gives the path, feature() its label.
    template <class Visitor>
    void sample(const Vec2f& raster, Numbers& numbers, Visitor&& visit) {
        const PathLimits& limits = options_.limits;
        const TechniqueSet& set = options_.techniques;
        walkFromLight(tracing_, limits, set.walkFromLight() ? limits.maxDepth : 0, numbers, light_);
        walkFromCamera(tracing_, limits, set.walkFromCamera() ? limits.maxDepth + 1 : 1, raster, numbers, camera_);

        auto report = [&](int s, int t, const Vec2f& where) {
            const double w = connection_.densities.weight(s, set, options_.heuristic);
            visit(Contribution{{s, t}, connection_.contribution * w, w, where});
        };
        for (int t = 2; t <= camera_.size; ++t) {
            if (set.hitLight && hitLight(tracing_, limits, camera_, t, connection_)) report(0, t, raster);
            if (!camera_.vertex[t - 1].onSurface() || t == limits.maxDepth + 1) continue;
            if (set.nextEvent && isSmooth(camera_.vertex[t - 1])) {
                sampleDirectLight(tracing_.scene(), camera_.vertex[t - 1], numbers(NumberStream::Connect, t - 2), direct_);
                if (connect(tracing_, limits, direct_, 1, camera_, t, connection_)) report(1, t, raster);
            }
            if (!set.connect || !isSmooth(camera_.vertex[t - 1])) continue;
            const int most = std::min(light_.size, limits.maxDepth + 1 - t);
            for (int s = 2; s <= most; ++s)
                if (isSmooth(light_.vertex[s - 1]) && connect(tracing_, limits, light_, s, camera_, t, connection_)) report(s, t, raster);
        }
        if (!set.lightImage) return;
        for (int s = 1; s <= light_.size; ++s)
            if ((s == 1 || isSmooth(light_.vertex[s - 1])) && connect(tracing_, limits, light_, s, camera_, 1, connection_))
                report(s, 1, connection_.raster);
    }

    /// The path of a technique of the current sample; for s = 1, t ≥ 2 only during its visit.
    void join(Technique technique, Path& path) const;
    /// The densities of the contribution being visited.
    const PathDensities& densities() const { return connection_.densities; }

private:
    /// Does the material at v scatter other than by delta lobes?
    bool isSmooth(const Vertex& v) const { return tracing_.scene().materialAt(v).hasSmooth; }

    BidirectionalOptions options_;
    Tracing tracing_;
    Subpath light_, camera_, direct_;
    Connection connection_;
};

}  // namespace ulam
