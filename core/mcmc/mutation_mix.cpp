#include "core/mcmc/mutation_mix.h"

namespace ulam {
namespace {

const Registry<Mutation>::Entry& entryOf(const std::string& name, const JsonNode& node) {
    const auto type = node.find("type");
    return Registry<Mutation>::instance().find(type ? type->string() : name, type ? *type : node);
}

/// Relative probability of being chosen; 1 unless given.
double weightOf(const JsonNode& node) {
    const auto given = node.find("weight");
    if (!given) return 1;
    const double weight = given->number();
    if (!(weight >= 0 && weight <= 1e9)) given->expected("a weight between 0 and 1e9");
    return weight;
}

}  // namespace

MutationMix MutationMix::fromConfig(const JsonNode& config, Space target) {
    std::vector<Entry> entries;
    double total = 0;
    for (const auto& [name, node] : config.members()) {
        const auto& registered = entryOf(name, node);
        Entry entry{name, weightOf(node), registered.create(node)};
        if (entry.mutation->space() == Space::Path && target == Space::Primary)
            node.fail(fmt::format("mutation \"{}\" works on paths, but this sampler's target is over primary numbers", registered.name),
                      "use it with the sampler \"mlt\"");
        total += entry.weight;
        entries.push_back(std::move(entry));
    }
    if (!(total > 0)) config.expected("at least one mutation with positive weight");
    return MutationMix(std::move(entries));
}

Json MutationMix::resolve(const JsonNode& config) {
    Json out = Json::object();
    for (const auto& [name, node] : config.members()) {
        const auto& registered = entryOf(name, node);
        Json entry = registered.resolve(node);
        entry["type"] = registered.name;
        entry["weight"] = weightOf(node);
        out[name] = entry;
    }
    return out;
}

double MutationMix::suitabilities(const Sample& x, std::vector<double>& terms) const {
    double z = 0;
    for (size_t i = 0; i < entries_.size(); ++i) z += terms[i] = entries_[i].weight * entries_[i].mutation->suitability(x);
    return z;
}

double MutationMix::largeStepProbability() const {
    double large = 0, all = 0;
    for (const Entry& e : entries_) {
        all += e.weight;
        if (e.mutation->isLargeStep()) large += e.weight;
    }
    return large / all;
}

}  // namespace ulam
