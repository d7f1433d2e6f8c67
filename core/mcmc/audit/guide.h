#pragma once
// Proposals that owe nothing to the mutation under audit: what integrals of its density are estimated with.

#include "core/mcmc/audit/marginals.h"
#include "core/mcmc/audit/subject.h"
#include "core/mcmc/path_edit.h"

namespace ulam::audit {

/// What became of x in y: the vertices kept at either end, and how the new ones scatter. Within a class proposals have
/// a density per area of the new vertices.
struct ProposalClass {
    int kept = 0;   ///< x_0 … of x kept by the light
    int first = 0;  ///< index in x of the first vertex kept by the camera
    int added = 0;  ///< edges between
    std::string lobes;

    ProposalClass(const Path& x, const Path& y);
    bool operator<(const ProposalClass& o) const {
        return std::tie(kept, first, added, lobes) < std::tie(o.kept, o.first, o.added, o.lobes);
    }
    bool operator==(const ProposalClass& o) const { return !(*this < o) && !(o < *this); }
    int grown() const { return added - 1; }
};

/// Makes paths of one class from x by walks from the kept ends: directions by the BSDF as bidirectional path tracing
/// draws them, or at angles to x's own direction that a pilot sample of proposals has shown, so that the estimate's
/// variance is small; which of the two does not matter for its mean.
class PathGuide {
public:
    /// `pilot`: proposals of the class.
    PathGuide(const AuditScene& scene, const Sample& x, const ProposalClass& c, const std::vector<Sample>& pilot);

    /// False where the class has no way to be grown.
    bool possible() const { return fromLight_ >= 0; }
    bool sample(StepContext& context, Random& random, Sample& y) const;
    double logDensity(const Sample& y) const;
    /// False for the shortest steps that the pilot has shown. Rounding decides about these: mutations allow for it by
    /// densities that reach a little below the shortest step they make.
    bool covers(const Sample& y) const;

private:
    /// One vertex to be grown, from the vertex `source` of y.
    struct Growth {
        int vertex, source;
        bool camera;              ///< by a walk from the camera
        bool raster = false;      ///< the first vertex that a raster position determines
        Vec3f center;             ///< direction that angles are measured from
        PilotLength length;       ///< angle, pixels on the film, or radii of the lens; empty: always as a walk goes
    };
    Reject grow(const Growth& g, PathEdit& edit, Random& random, Path& path) const;
    double pdf(const Growth& g, const Sample& y) const;
    /// What `length` is of.
    double lengthOf(const Growth& g, const Sample& y) const;
    /// How far y's point on the lens is from x's, in radii of the lens.
    double onLens(const Sample& y) const;

    const AuditScene& scene_;
    Tracing tracing_;
    const Sample& x_;
    ProposalClass class_;
    Path pattern_;  ///< a path of the class
    int fromLight_ = -1;
    std::vector<Growth> growths_;  ///< in the order in which they are made
};

}  // namespace ulam::audit
