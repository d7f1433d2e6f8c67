// bdpt: bidirectional path tracing with all techniques (Veach 1997, ch. 10).

#include "core/render/independent_run.h"

namespace ulam {
namespace {

class Bdpt : public Sampler {
public:
    struct Parameters {
        PathLimits limits;
        std::string heuristic = "balance";
        bool techniqueImages = false;
        template <class V>
        void describe(V& v) {
            limits.describe(v);
            v("heuristic", heuristic, {.help = "how techniques are weighted against each other", .choices = {"balance", "power"}});
            v("technique_images", techniqueImages, {.help = "also write the image of each technique (s, t), weighted and unweighted"});
        }
    };
    explicit Bdpt(const Parameters& p) : parameters_(p) {}

    std::vector<MemoryPhase> memory(const RunContext& context) const override {
        return IndependentRun::memory(context, {.splats = true, .techniqueDepth = parameters_.techniqueImages ? parameters_.limits.maxDepth : 0});
    }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        BidirectionalOptions options;
        options.limits = parameters_.limits;
        options.heuristic = parameters_.heuristic == "power" ? Heuristic::Power : Heuristic::Balance;
        return std::make_unique<IndependentRun>(context, [&] { return makeBidirectionalSource(context.scene, options); }, parameters_.techniqueImages);
    }

private:
    Parameters parameters_;
};

ULAM_REGISTER_SAMPLER(Bdpt, "bdpt", "bidirectional path tracing: all ways of joining a light walk and a camera walk, weighted");

}  // namespace
}  // namespace ulam
