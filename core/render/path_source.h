#pragma once
// Path tracing (Kajiya 1986) with next-event estimation and hits of the light, combined by multiple importance sampling
// (Veach 1997, §9.2). Of a path only its last edge is kept. It shares nothing with bidirectional path tracing but the
// single bounce, so that each tests the other.

#include "core/path/densities.h"
#include "core/render/independent_run.h"

namespace ulam {

/// Directions come from the BSDF alone. A guide offers others, in the numbers of the Light stream:
///   share(v)                     how often they are taken at v
///   sample(from, choice, u, v)   a direction
///   pdf(from, w)                 its density per solid angle
struct NoGuide {
    static constexpr bool present = false;
};

template <class Guide = NoGuide>
class PathSource : public SampleSource {
public:
    PathSource(const Scene& scene, const PathLimits& limits, Heuristic heuristic, const Guide& guide = {})
        : limits_(limits), heuristic_(heuristic), guide_(guide), tracing_(scene),
          options_{limits, {.connect = false, .lightImage = false}, heuristic} {}

    const BidirectionalOptions& options() const override { return options_; }
    bool isGuided() const override { return Guide::present; }
    uint64_t rays() const override { return tracing_.rays(); }

    void sample(const Vec2f& raster, Numbers& numbers, ContributionSink& sink) override {
        const Scene& scene = tracing_.scene();
        Vertex vertices[2];
        Vertex *previous = &vertices[0], *v = &vertices[1];
        *previous = scene.sensor->samplePosition(numbers(NumberStream::Camera, 0));
        Vec3f w = scene.sensor->direction(*previous, raster);
        const Perspective::Response response = scene.sensor->respond(*previous, w);
        if (!(response.pdf > 0)) return;
        throughput_ = Spectrum(response.importance * cosine(*previous, w) / (response.pdf * scene.sensor->positionPdf(*previous)));
        raster_ = raster;
        feature_ = kNone;
        directionPdf_ = 0;
        for (int depth = 1; tracing_.next(*previous, w, *v); ++depth) {
            if (feature_ == kNone) feature_ = crossed(*previous, *v);
            const Edge back(*v, *previous);
            addHit(*v, back, *previous, depth, sink);
            if (depth == limits_.maxDepth || !v->onSurface()) return;
            const double q = limits_.hasRoulette() ? limits_.continuation(depth, albedoAt(scene, *v)) : 1;
            const Block& u = numbers(NumberStream::Camera, depth);
            const bool smooth = scene.materialAt(*v).hasSmooth;
            double share = 0;
            if constexpr (Guide::present) share = smooth ? guide_.share(*v) : 0;
            if (smooth) addDirectLight(*v, back, share, q, depth, numbers(NumberStream::Connect, depth - 1), sink);

            if (!(u[3] < q) || !scatterOn(*v, back.direction, share, q, u, numbers, depth, w)) return;
            std::swap(previous, v);
        }
    }

private:
    double combined(double own, double other) const {
        return heuristic_ == Heuristic::Balance ? own / (own + other) : own * own / (own * own + other * other);
    }

    /// Density of a direction off a vertex where the BSDF has density bsdfPdf.
    double mixedPdf(const Vertex& v, const Vec3f& w, double bsdfPdf, double share) const {
        double pdf = (1 - share) * bsdfPdf;
        if constexpr (Guide::present)
            if (share > 0 && !isDelta(v.lobe)) pdf += share * guide_.pdf(v.position, w);
        return pdf;
    }

    uint32_t crossed(const Vertex& from, const Vertex& to) const {
        const Features& features = tracing_.scene().features;
        return features.empty() || !to.onSurface() ? kNone : features.crossed(from.position, to.position);
    }

    void addHit(const Vertex& v, const Edge& back, const Vertex& previous, int depth, ContributionSink& sink) {
        const Scene& scene = tracing_.scene();
        if (scene.emitterAt(v) == kNone) return;
        const Emission e = emission(scene, v, back.direction);
        if (isBlack(e.radiance)) return;
        const double weight =
            directionPdf_ > 0 ? combined(back.toAreaA(directionPdf_), directLightPdf(scene, previous, v)) : 1;
        sink.add({{0, depth + 1}, throughput_ * e.radiance * weight, weight, raster_}, feature_);
    }

    void addDirectLight(Vertex& v, const Edge& back, double share, double q, int depth, const Block& numbers, ContributionSink& sink) {
        const Scene& scene = tracing_.scene();
        sampleDirectLight(scene, v, numbers, light_);
        const Vertex& x0 = light_.vertex[0];
        const Edge edge(x0, v);
        if (!(edge.geometry() > 0)) return;
        const Emission e = emission(scene, x0, edge.direction);
        if (isBlack(e.radiance)) return;
        const Scattering s = scatter(scene, v, Lobe::Smooth, -edge.direction, back.direction);
        if (isBlack(s.f) || !tracing_.visible(x0, v)) return;
        v.lobe = Lobe::Smooth;
        const double direct = light_.forward[0];
        const double hit = hittable(x0) ? edge.toAreaA(mixedPdf(v, -edge.direction, s.pdfToLight, share) * q) : 0;
        const double weight = combined(direct, hit);
        const uint32_t feature = feature_ == kNone ? crossed(v, x0) : feature_;
        sink.add({{1, depth + 1}, throughput_ * e.radiance * s.f * (edge.geometry() * weight / direct), weight, raster_}, feature);
    }

    /// The next direction; false where the walk ends.
    bool scatterOn(Vertex& v, const Vec3f& back, double share, double q, const Block& u, Numbers& numbers, int depth, Vec3f& w) {
        const Scene& scene = tracing_.scene();
        ScatteredDirection next;
        bool guided = false;
        if constexpr (Guide::present) {
            const Block& choice = numbers(NumberStream::Light, depth);
            if ((guided = choice[0] < share)) {
                v.lobe = Lobe::Smooth;
                next.direction = guide_.sample(v.position, choice[0] / share, choice[1], choice[2]);
                next.scattering = scatter(scene, v, v.lobe, next.direction, back);
            }
        }
        if (!guided && !sampleScattering(scene, v, back, From::Camera, u, next)) return false;
        const double pdf = mixedPdf(v, next.direction, next.scattering.pdfToLight, share);
        if (isBlack(next.scattering.f) || !(pdf > 0)) return false;
        w = next.direction;
        throughput_ *= next.scattering.f * (cosine(v, w) / (pdf * q));
        directionPdf_ = isDelta(v.lobe) ? 0 : pdf * q;
        return true;
    }

    PathLimits limits_;
    Heuristic heuristic_;
    Guide guide_;
    Tracing tracing_;
    BidirectionalOptions options_;
    Subpath light_;
    // Of the sample being made:
    Spectrum throughput_;
    Vec2f raster_;
    uint32_t feature_ = kNone;  ///< the first that was crossed, from the camera
    double directionPdf_ = 0;   ///< of the last direction; 0: next-event estimation was not possible there
};

}  // namespace ulam
