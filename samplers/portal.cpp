// portal: path tracing that knows the openings light comes through. Off vertices on the camera's side of the scene's
// features, directions are also drawn towards the openings nearby. It makes references for the grid of holes in a way that
// shares nothing with bidirectional path tracing but the single bounce, and needs a scene with features.

#include "core/render/path_source.h"

namespace ulam {
namespace {

/// The openings: a centred square in each cell of the features' grid. From a vertex, only the cells around its foot on
/// the plane are sampled.
class Openings {
public:
    static constexpr bool present = true;

    Openings(const Features& features, const Vec3f& camera, double opening, int reach, double share)
        : f_(features), opening_(opening), reach_(reach), share_(share), normal_(normalize(cross(features.across, features.down))) {
        cameraSide_ = dot(normal_, camera - f_.corner) > 0;
        area_ = double(length(f_.across)) * length(f_.down) / (f_.rows * f_.columns) * opening * opening;
    }

    double share(const Vertex& v) const { return (dot(normal_, v.position - f_.corner) > 0) == cameraSide_ ? share_ : 0; }

    Vec3f sample(const Vec3f& from, double choice, double u, double v) const {
        const Cells c = cellsAround(from);
        const int i = std::min(int(choice * c.count()), c.count() - 1);
        const int cellColumn = c.column0 + i % c.columns(), cellRow = c.row0 + i / c.columns();
        const double column = cellColumn + 0.5 + (u - 0.5) * opening_, row = cellRow + 0.5 + (v - 0.5) * opening_;
        return normalize(f_.corner + f_.across * float(column / f_.columns) + f_.down * float(row / f_.rows) - from);
    }

    /// Per solid angle.
    double pdf(const Vec3f& from, const Vec3f& w) const {
        const double height = dot(normal_, f_.corner - from), slope = dot(normal_, w);
        if (!(height * slope > 0)) return 0;
        const double distance = height / slope;
        const Vec2f g = grid(from + w * float(distance));
        const int column = int(std::floor(g.x)), row = int(std::floor(g.y));
        const Cells c = cellsAround(from);
        if (column < c.column0 || column > c.column1 || row < c.row0 || row > c.row1) return 0;
        if (std::abs(g.x - (column + 0.5)) > 0.5 * opening_ || std::abs(g.y - (row + 0.5)) > 0.5 * opening_) return 0;
        return distance * distance / (std::abs(slope) * area_ * c.count());
    }

private:
    struct Cells {
        int column0, column1, row0, row1;
        int columns() const { return column1 - column0 + 1; }
        int count() const { return columns() * (row1 - row0 + 1); }
    };

    /// In units of cells.
    Vec2f grid(const Vec3f& p) const {
        const Vec3f d = p - f_.corner;
        return {dot(d, f_.across) / length2(f_.across) * float(f_.columns), dot(d, f_.down) / length2(f_.down) * float(f_.rows)};
    }
    Cells cellsAround(const Vec3f& p) const {
        const Vec2f g = grid(p);
        const int column = std::clamp(int(std::floor(g.x)), 0, f_.columns - 1), row = std::clamp(int(std::floor(g.y)), 0, f_.rows - 1);
        return {std::max(0, column - reach_), std::min(f_.columns - 1, column + reach_), std::max(0, row - reach_), std::min(f_.rows - 1, row + reach_)};
    }

    const Features& f_;
    double opening_;
    int reach_;
    double share_;
    Vec3f normal_;
    bool cameraSide_;
    double area_;  ///< of one opening
};

class Portal : public Sampler {
public:
    struct Parameters {
        PathLimits limits;
        double opening = 0.2, share = 0.9;
        int reach = 1;
        template <class V>
        void describe(V& v) {
            limits.describe(v);
            v("opening", opening, {.help = "side of the square that is sampled in the middle of each feature's cell, as a fraction of the cell", .min = 0, .max = 1, .minExclusive = true});
            v("share", share, {.help = "share of directions drawn towards the openings; the rest follows the BSDF", .min = 0, .max = 0.99});
            v("reach", reach, {.help = "cells to each side of the nearest one that are sampled", .min = 0, .max = 64});
        }
    };
    explicit Portal(const Parameters& p) : parameters_(p) {}

    std::vector<MemoryPhase> memory(const RunContext& context) const override {
        return IndependentRun::memory(context, {});
    }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        const Scene& scene = context.scene;
        if (scene.features.empty()) fail(ExitCode::InvalidConfig, "the sampler portal needs a scene with features, such as the generator grid_of_holes");
        const Openings openings(scene.features, scene.sensor->position(), parameters_.opening, parameters_.reach,
                                parameters_.share);
        auto run = std::make_unique<IndependentRun>(context, [&] {
            return std::make_unique<PathSource<Openings>>(scene, parameters_.limits, Heuristic::Balance, openings);
        });
        run->noteBias(missedLight(scene, {.connect = false, .lightImage = false}));
        return run;
    }

private:
    Parameters parameters_;
};

ULAM_REGISTER_SAMPLER(Portal, "portal", "path tracing that also draws directions through the scene's named openings");

}  // namespace
}  // namespace ulam
