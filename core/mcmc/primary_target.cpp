#include "core/mcmc/target.h"

namespace ulam {
namespace {

class PrimaryTarget : public Target {
public:
    PrimaryTarget(const Scene& scene, const BidirectionalOptions& options, const Importance& importance)
        : scene_(scene), importance_(importance), sampler_(scene, options) {}

    Space space() const override { return Space::Primary; }
    Tracing& tracing() override { return sampler_.tracing(); }

    Reject evaluateNumbers(Sample& y, Random& random) override {
        y.splats.clear();
        y.path.resize(0);
        const double sum = trace(y.u, random, [&](const Contribution& c) { deposit(c, y.splats); });
        if (!checkFinite(Cause::Target, sum)) return Reject::NotFinite;
        if (!(sum > 0)) return Reject::ZeroTarget;
        y.logTarget = std::log(sum);
        for (int i = 0; i < y.splats.size(); ++i) y.splats[i].value /= sum;
        return Reject::None;
    }

    Reject evaluatePath(Sample&) override { return Reject::ZeroTarget; }
    double redrawTechnique(Sample&, Random&, bool) override { return 0; }
    double logTechnique(Sample&) override { return 0; }

    double bootstrapWeight(Random& random) override {
        scratch_.clear();
        return trace(scratch_, random, [](const Contribution&) {});
    }

    bool seed(Random& random, double, Sample& x) override {
        x.u.clear();
        return evaluateNumbers(x, random) == Reject::None;
    }

private:
    template <class Visitor>
    double trace(PrimaryVector& u, Random& random, Visitor&& visit) {
        Numbers numbers(u, random);
        const Vec2f raster = scene_.sensor->sampleRaster(numbers(NumberStream::Camera, 0));
        double sum = 0;
        sampler_.sample(raster, numbers, [&](const Contribution& c) {
            sum += importance_(c.value);
            visit(c);
        });
        // States are points of a union of cubes, each as large as what is used (Green 1995): a step to a state that uses
        // more draws the rest uniformly, the step back drops it. Numbers kept after acceptance alone would break the balance.
        numbers.forgetUnused();
        return sum;
    }

    void deposit(const Contribution& c, Splats& splats) {
        Splat splat{c.raster, c.value};
        if (!scene_.features.empty()) {
            sampler_.join(c.technique, path_);
            splat.feature = featureOf(scene_.features, path_);
        }
        // Contributions through the sample's own pixel share a splat, as long as their feature is the same or room is short.
        const bool scarce = splats.size() > kMaxDepth;
        for (int i = 0; i < splats.size(); ++i) {
            if (splats[i].raster == splat.raster && (scarce || splats[i].feature == splat.feature)) {
                splats[i].value += splat.value;
                return;
            }
        }
        splats.add(splat);
    }

    const Scene& scene_;
    const Importance& importance_;
    BidirectionalSampler sampler_;
    PrimaryVector scratch_;
    Path path_;
};

}  // namespace

std::unique_ptr<Target> makePrimaryTarget(const Scene& scene, const BidirectionalOptions& options, const Importance& importance) {
    return std::make_unique<PrimaryTarget>(scene, options, importance);
}

}  // namespace ulam
