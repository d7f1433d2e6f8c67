// pssmlt: Metropolis light transport on primary samples (Kelemen et al. 2002), over whole samples of bidirectional path
// tracing or of path tracing.

#include "core/render/chain_run.h"

namespace ulam {
namespace {

Json primaryMutations() {
    return {{"large_step", {{"weight", 0.3}}}, {"kelemen_step", {{"weight", 0.7}}}};
}

class Pssmlt : public Sampler {
public:
    struct Parameters {
        PathLimits limits;
        ChainParameters chains;
        std::string base = "bdpt";
        std::string deposit = "kelemen";
        JsonNode mutations{primaryMutations()};
        template <class V>
        void describe(V& v) {
            limits.describe(v);
            chains.describe(v);
            v("base", base, {.help = "what a primary sample makes", .choices = {"bdpt", "path"}});
            v("deposit", deposit, {.help = "kelemen: large steps also count as independent samples; expected_values: acceptance-weighted deposits",
                                   .choices = {"kelemen", "expected_values"}});
            v("mutations", mutations,
              {.help = "mutations by name, each with its weight and parameters (ulam list mutations)",
               .example = R"({"large_step": {"weight": 0.3}, "kelemen_step": {"weight": 0.7}})"});
        }
    };
    explicit Pssmlt(const Parameters& p) : parameters_(p), importance_(makeImportance(p.chains.target)) {
        MutationMix::fromConfig(parameters_.mutations, Space::Primary);
    }

    bool isChainSampler() const override { return true; }

    std::vector<MemoryPhase> memory(const RunContext& context) const override {
        return ChainRun::memory(context, parameters_.chains, parameters_.limits);
    }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        BidirectionalOptions options;
        options.limits = parameters_.limits;
        if (parameters_.base == "path") options.techniques = {.hitLight = true, .nextEvent = true, .connect = false, .lightImage = false};
        auto run = std::make_unique<ChainRun>(context, parameters_.chains, options,
                                          MutationMix::fromConfig(parameters_.mutations, Space::Primary),
                                          parameters_.deposit == "kelemen" ? Deposit::Kelemen : Deposit::ExpectedValues,
                                          [&] { return makePrimaryTarget(context.scene, options, *importance_); });
        run->noteBias(missedLight(context.scene, options.techniques));
        return run;
    }

private:
    Parameters parameters_;
    std::unique_ptr<Importance> importance_;
};

ULAM_REGISTER_SAMPLER(Pssmlt, "pssmlt", "primary sample space Metropolis light transport (Kelemen et al. 2002)");

}  // namespace
}  // namespace ulam
