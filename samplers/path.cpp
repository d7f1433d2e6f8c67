// path: path tracing with next-event estimation and multiple importance sampling.

#include "core/render/path_source.h"

namespace ulam {
namespace {

class PathTracer : public Sampler {
public:
    struct Parameters {
        PathLimits limits;
        std::string heuristic = "balance";
        template <class V>
        void describe(V& v) {
            limits.describe(v);
            v("heuristic", heuristic, {.help = "how hits of the light are weighted against next-event estimation", .choices = {"balance", "power"}});
        }
    };
    explicit PathTracer(const Parameters& p) : parameters_(p) {}

    std::vector<MemoryPhase> memory(const RunContext& context) const override {
        return IndependentRun::memory(context, {});
    }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        const Heuristic heuristic = parameters_.heuristic == "power" ? Heuristic::Power : Heuristic::Balance;
        auto run = std::make_unique<IndependentRun>(
            context, [&] { return std::make_unique<PathSource<>>(context.scene, parameters_.limits, heuristic); });
        run->noteBias(missedLight(context.scene, {.connect = false, .lightImage = false}));
        return run;
    }

private:
    Parameters parameters_;
};

ULAM_REGISTER_SAMPLER(PathTracer, "path", "path tracing from the camera, with next-event estimation");

}  // namespace
}  // namespace ulam
