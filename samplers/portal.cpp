// portal: path tracing that knows the openings light comes through. Off vertices on the camera's side of the scene's
// features, directions are also drawn towards the openings nearby; direct light and hits of a light are combined by the
// balance heuristic. It makes references for the grid of holes in a way that shares nothing with bidirectional path
// tracing but the single bounce, and needs a scene with features.

#include "core/render/independent_run.h"

namespace ulam {
namespace {

/// The openings: a centred square in each cell of the features' grid. From a vertex, only the cells around its foot on
/// the plane are sampled.
class Openings {
public:
    Openings(const Features& features, const Vec3f& camera, double opening, int reach)
        : f_(features), opening_(opening), reach_(reach), normal_(normalize(cross(features.across, features.down))) {
        cameraSide_ = dot(normal_, camera - f_.corner) > 0;
        area_ = double(length(f_.across)) * length(f_.down) / (f_.rows * f_.columns) * opening * opening;
    }

    bool onCameraSide(const Vec3f& p) const { return (dot(normal_, p - f_.corner) > 0) == cameraSide_; }

    Vec3f sample(const Vec3f& from, double choice, double u, double v) const {
        const Cells c = cellsAround(from);
        const int i = std::min(int(choice * c.count()), c.count() - 1);
        const double column = c.column0 + i % c.columns() + 0.5 + (u - 0.5) * opening_;
        const double row = c.row0 + i / c.columns() + 0.5 + (v - 0.5) * opening_;
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
        if (std::abs(g.x - column - 0.5) > 0.5 * opening_ || std::abs(g.y - row - 0.5) > 0.5 * opening_) return 0;
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
    Vec3f normal_;
    bool cameraSide_;
    double area_;  ///< of one opening
};

class PortalSource : public SampleSource {
public:
    PortalSource(const Scene& scene, const PathLimits& limits, const Openings& openings, double share)
        : limits_(limits), openings_(openings), share_(share), tracing_(scene) {}

    uint64_t rays() const override { return tracing_.rays(); }

    void sample(const Vec2f& raster, Numbers& numbers, ContributionSink& sink) override {
        const Scene& scene = tracing_.scene();
        Vertex previous = scene.sensor->samplePosition(numbers(NumberStream::Camera, 0)), v;
        Vec3f w = scene.sensor->direction(raster);
        if (!tracing_.next(previous, w, v)) return;
        Spectrum throughput(1.0);
        uint32_t feature = crossed(previous, v);
        double directionPdf = 0;  // of w from the last smooth vertex; 0: next-event estimation was not possible there
        for (int depth = 1;; ++depth) {
            const Edge edge(v, previous);
            addEmission(v, edge, throughput, directionPdf, feature, depth, raster, sink, previous);
            if (depth == limits_.maxDepth || !v.onSurface()) return;
            const double q = limits_.continuation(depth, albedoAt(scene, v));
            const Block& u = numbers(NumberStream::Camera, depth);
            const bool smooth = scene.materialAt(v).hasSmooth();
            const double share = smooth && openings_.onCameraSide(v.position) ? share_ : 0;
            if (smooth) addDirectLight(v, edge.direction, throughput, share, feature, depth, raster, numbers(NumberStream::Connect, depth), sink);

            if (!(u[3] < q)) return;
            const Block& choice = numbers(NumberStream::Light, depth);
            Scattering s = Scattering::none();
            if (choice[0] < share) {
                w = openings_.sample(v.position, choice[0] / share, choice[1], choice[2]);
                v.lobe = Lobe::Smooth;
                s = scatter(scene, v, v.lobe, w, edge.direction);
            } else {
                ScatteredDirection sampled;
                if (!sampleScattering(scene, v, edge.direction, From::Camera, u, sampled)) return;
                w = sampled.direction;
                s = sampled.scattering;
            }
            const double pdf = isDelta(v.lobe) ? s.pdfToLight : mixedPdf(v, w, s.pdfToLight, share);
            if (isBlack(s.f) || !(pdf > 0)) return;
            throughput *= s.f * (cosine(v, w) / (pdf * q));
            directionPdf = isDelta(v.lobe) ? 0 : pdf * q;
            previous = v;
            if (!tracing_.next(previous, w, v)) return;
            if (feature == kNone) feature = crossed(previous, v);
        }
    }

private:
    uint32_t crossed(const Vertex& a, const Vertex& b) const {
        return b.onSurface() ? tracing_.scene().features.crossed(a.position, b.position) : kNone;
    }
    double mixedPdf(const Vertex& v, const Vec3f& w, double bsdfPdf, double share) const {
        return (1 - share) * bsdfPdf + (share > 0 ? share * openings_.pdf(v.position, w) : 0);
    }

    void addEmission(const Vertex& v, const Edge& toPrevious, const Spectrum& throughput, double directionPdf, uint32_t feature, int depth,
                     const Vec2f& raster, ContributionSink& sink, const Vertex& previous) {
        const Emission e = emission(tracing_.scene(), v, toPrevious.direction);
        if (isBlack(e.radiance)) return;
        double weight = 1;
        if (directionPdf > 0) {
            const double hit = toPrevious.toAreaA(directionPdf), direct = directLightPdf(tracing_.scene(), previous, v);
            weight = hit / (hit + direct);
        }
        sink.add({{0, depth + 1}, throughput * e.radiance * weight, weight, raster}, feature);
    }

    void addDirectLight(Vertex v, const Vec3f& toCamera, const Spectrum& throughput, double share, uint32_t feature, int depth, const Vec2f& raster,
                        const Block& numbers, ContributionSink& sink) {
        const Scene& scene = tracing_.scene();
        sampleDirectLight(scene, v, numbers, light_);
        const Vertex& x0 = light_.vertex[0];
        const Edge edge(x0, v);
        if (!(edge.geometry() > 0)) return;
        const Emission e = emission(scene, x0, edge.direction);
        if (isBlack(e.radiance)) return;
        v.lobe = Lobe::Smooth;
        const Scattering s = scatter(scene, v, Lobe::Smooth, -edge.direction, toCamera);
        if (isBlack(s.f) || !tracing_.visible(x0, v)) return;
        const double direct = light_.forward[0];
        const double q = depth + 1 <= limits_.maxDepth ? limits_.continuation(depth, albedoAt(scene, v)) : 0;
        const double hit = hittable(x0) ? edge.toAreaA(mixedPdf(v, -edge.direction, s.pdfToLight, share)) * q : 0;
        const double weight = direct / (direct + hit);
        if (feature == kNone && x0.onSurface()) feature = scene.features.crossed(v.position, x0.position);
        sink.add({{1, depth + 1}, throughput * e.radiance * s.f * (edge.geometry() * weight / direct), weight, raster}, feature);
    }

    PathLimits limits_;
    Openings openings_;
    double share_;
    Tracing tracing_;
    Subpath light_;
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

    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        const Scene& scene = context.scene;
        if (scene.features.empty()) fail(ExitCode::InvalidConfig, "the sampler portal needs a scene with features, such as the generator grid_of_holes");
        const Openings openings(scene.features, scene.sensor->samplePosition({}).position, parameters_.opening, parameters_.reach);
        auto run = std::make_unique<IndependentRun>(
            context, [&] { return std::make_unique<PortalSource>(scene, parameters_.limits, openings, parameters_.share); });
        run->noteBias(missedLight(scene, {.connect = false, .lightImage = false}));
        return run;
    }

private:
    Parameters parameters_;
};

ULAM_REGISTER_SAMPLER(Portal, "portal", "path tracing that also draws directions through the scene's named openings");

}  // namespace
}  // namespace ulam
