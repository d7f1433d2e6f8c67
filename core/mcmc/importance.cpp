// The scalar targets.

#include "core/mcmc/target.h"

namespace ulam {

std::unique_ptr<Importance> makeImportance(const std::string& name) {
    const JsonNode sampler(Json{{"target", name}});  // whose parameter it is
    return Registry<Importance>::instance().find(name, sampler.at("target")).create(JsonNode(Json::object()));
}

namespace {

struct NoParameters {
    template <class V>
    void describe(V&) {}
};

class Luminance : public Importance {
public:
    using Parameters = NoParameters;
    explicit Luminance(const Parameters&) {}
    double operator()(const Spectrum& f) const override { return luminance(f); }
};

class MeanComponent : public Importance {
public:
    using Parameters = NoParameters;
    explicit MeanComponent(const Parameters&) {}
    double operator()(const Spectrum& f) const override { return (f.x + f.y + f.z) / 3; }
};

class LargestComponent : public Importance {
public:
    using Parameters = NoParameters;
    explicit LargestComponent(const Parameters&) {}
    double operator()(const Spectrum& f) const override { return maxComponent(f); }
};

ULAM_REGISTER_TARGET(Luminance, "luminance", "luminance of the contribution");
ULAM_REGISTER_TARGET(MeanComponent, "mean", "mean of the three components: colours weigh alike");
ULAM_REGISTER_TARGET(LargestComponent, "max", "largest of the three components");

}  // namespace
}  // namespace ulam
