// light: particle tracing. Walks start on the lights and every vertex is joined to the lens. Light that reaches the
// camera by a mirror or glass it sees directly, and lights that it sees directly, are shown only where a vertex can be
// joined to the lens; the run says so.

#include "core/render/independent_run.h"

namespace ulam {
namespace {

class LightTracer : public Sampler {
public:
    struct Parameters {
        PathLimits limits;
        template <class V>
        void describe(V& v) {
            limits.describe(v);
        }
    };
    explicit LightTracer(const Parameters& p) : parameters_(p) {}

    std::vector<MemoryPhase> memory(const RunContext& context) const override {
        return IndependentRun::memory(context, {.samples = false, .splats = true});
    }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        BidirectionalOptions options;
        options.limits = parameters_.limits;
        options.techniques = {.hitLight = false, .nextEvent = false, .connect = false, .lightImage = true};
        auto run = std::make_unique<IndependentRun>(context, [&] { return makeBidirectionalSource(context.scene, options); });
        run->noteBias(missedLight(context.scene, options.techniques));
        return run;
    }

private:
    Parameters parameters_;
};

ULAM_REGISTER_SAMPLER(LightTracer, "light", "particle tracing from the lights, every vertex joined to the lens");

}  // namespace
}  // namespace ulam
