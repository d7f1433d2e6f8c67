#include "core/mcmc/target.h"
#include "core/path/primary_map.h"

namespace ulam {
namespace {

class PathTarget : public Target {
public:
    PathTarget(const Scene& scene, const BidirectionalOptions& options, const Importance& importance)
        : scene_(scene), importance_(importance), sampler_(scene, options) {}

    Space space() const override { return Space::Path; }
    Tracing& tracing() override { return sampler_.tracing(); }

    Reject evaluateNumbers(Sample& y, Random& random) override {
        if (!makePath(tracing(), limits(), y.technique, y.u, random, y.path)) return Reject::Missed;
        if (!evaluate(scene_, y.path, y.factors)) return Reject::ZeroTarget;
        return evaluatePath(y);
    }

    Reject evaluatePath(Sample& y) override {
        const Spectrum f = y.factors.contribution();
        const double pi = importance_(f);
        if (!checkFinite(Cause::Target, pi)) return Reject::NotFinite;
        if (!(pi > 0)) return Reject::ZeroTarget;
        const auto response = scene_.sensor->respond(y.path.camera(), -y.factors.edge[y.path.length() - 1].direction);
        if (!(response.importance > 0)) return Reject::OffScreen;
        y.logTarget = std::log(pi);
        y.splats.clear();
        y.splats.add({response.raster, f / pi, scene_.features.empty() ? kNone : featureOf(scene_.features, y.path)});
        return Reject::None;
    }

    double redrawTechnique(Sample& x, Random& random, bool invertNumbers) override {
        const PathDensities d = densities(scene_, limits(), x.path, x.factors);
        std::array<double, kMaxVertices + 1> c;
        double u = random();
        int s = -1;
        for (int i = 0; i < d.size; ++i) {
            c[size_t(i)] = weight(d, i);
            if (c[size_t(i)] > 0) s = i;
            if ((u -= c[size_t(i)]) < 0) break;
        }
        if (s < 0) return -std::numeric_limits<double>::infinity();
        x.technique = {s, d.size - s};
        x.logDensity = d.log(s);
        if (invertNumbers && !invertPath(tracing(), limits(), x.technique, x.path, random, x.u)) return -std::numeric_limits<double>::infinity();
        return std::log(c[size_t(s)]);
    }

    double logTechnique(Sample& y) override {
        const PathDensities d = densities(scene_, limits(), y.path, y.factors);
        y.logDensity = d.log(y.technique.s);
        return std::log(weight(d, y.technique.s));
    }

    double bootstrapWeight(Random& random) override {
        return trace(random, [](const Contribution&, double) {});
    }

    bool seed(Random& random, double choice, Sample& x) override {
        Random again = random;
        const double total = trace(again, [](const Contribution&, double) {});
        double left = choice * total;
        bool found = false;
        trace(random, [&](const Contribution& c, double pi) {
            if (left < 0 || !(pi > 0)) return;
            left -= pi;
            sampler_.join(c.technique, x.path);  // the last one stays: rounding cannot lose it
            found = true;
        });
        x.u.clear();
        return found && evaluate(scene_, x.path, x.factors) && evaluatePath(x) == Reject::None;
    }

private:
    const PathLimits& limits() const { return sampler_.options().limits; }

    /// c(s,t|x): the balance weights over all techniques that can make the path.
    static double weight(const PathDensities& d, int s) {
        return d.possible(s) && std::isfinite(d.log(s)) ? d.weight(s, TechniqueSet{}, Heuristic::Balance) : 0;
    }

    template <class Visitor>
    double trace(Random& random, Visitor&& visit) {
        scratch_.clear();
        Numbers numbers(scratch_, random);
        const Vec2f raster = scene_.sensor->sampleRaster(numbers(NumberStream::Camera, 0));
        double sum = 0;
        sampler_.sample(raster, numbers, [&](const Contribution& c) {
            const double pi = importance_(c.value);
            sum += pi;
            visit(c, pi);
        });
        return sum;
    }

    const Scene& scene_;
    const Importance& importance_;
    BidirectionalSampler sampler_;
    PrimaryVector scratch_;
};

}  // namespace

std::unique_ptr<Target> makePathTarget(const Scene& scene, const BidirectionalOptions& options, const Importance& importance) {
    return std::make_unique<PathTarget>(scene, options, importance);
}

}  // namespace ulam
