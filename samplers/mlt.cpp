// mlt: Metropolis light transport on path space (Veach & Guibas 1997; Veach 1997, ch. 11).

#include "core/render/chain_run.h"

namespace ulam {
namespace {

Json pathMutations() {
    return {{"bidirectional", {{"weight", 1}}}, {"lens", {{"weight", 1}}}};
}

class Mlt : public Sampler {
public:
    struct Parameters {
        PathLimits limits;
        ChainParameters chains;
        JsonNode mutations{pathMutations()};
        template <class V>
        void describe(V& v) {
            limits.describe(v);
            chains.describe(v);
            v("mutations", mutations,
              {.help = "mutations by name, each with its weight and parameters (ulam list mutations)",
               .example = R"({"bidirectional": {}, "lens": {"weight": 2}})"});
        }
    };
    explicit Mlt(const Parameters& p) : parameters_(p), importance_(makeImportance(p.chains.target)) {
        MutationMix::fromConfig(parameters_.mutations, Space::Path);
    }

    bool isChainSampler() const override { return true; }

    std::vector<MemoryPhase> memory(const RunContext& context) const override {
        return ChainRun::memory(context, parameters_.chains, parameters_.limits);
    }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        BidirectionalOptions options;
        options.limits = parameters_.limits;
        return std::make_unique<ChainRun>(context, parameters_.chains, options,
                                          MutationMix::fromConfig(parameters_.mutations, Space::Path), Deposit::ExpectedValues,
                                          [&] { return makePathTarget(context.scene, options, *importance_); });
    }

private:
    Parameters parameters_;
    std::unique_ptr<Importance> importance_;
};

ULAM_REGISTER_SAMPLER(Mlt, "mlt", "Metropolis light transport: Markov chains on paths (Veach and Guibas 1997)");

}  // namespace
}  // namespace ulam
