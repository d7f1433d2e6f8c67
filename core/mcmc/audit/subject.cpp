#include "core/mcmc/audit/subject.h"

#include <map>

namespace ulam::audit {

void Failures::add(uint64_t trial, std::string message) {
    ++count_;
    if (first_.size() < kKept) first_.push_back({trial, std::move(message)});
}

void Failures::merge(const Failures& later) {
    count_ += later.count_;
    for (const Failure& f : later.first_)
        if (first_.size() < kKept) first_.push_back(f);
}

namespace {

Json unequalMix(const std::string& mutation, const std::vector<std::string>& partners) {
    Json config = {{mutation, {{"weight", 1}}}};
    // Unequal weights, none of them 1: a forgotten selection ratio cannot cancel.
    double weight = 0.37;
    for (const std::string& partner : partners) {
        config[partner] = {{"weight", weight}};
        weight = weight > 1 ? weight * 0.41 : weight * 1.7;
    }
    return config;
}

}  // namespace

Subject::Subject(const std::string& mutation, Space target, const std::vector<std::string>& partners)
    : Subject(target, unequalMix(mutation, partners)) {}

Subject::Subject(Space target, const Json& mix)
    : target_(target), mix_(MutationMix::fromConfig(JsonNode(mix), target)), importance_(makeImportance("luminance")) {}

std::unique_ptr<Target> Subject::makeTarget(const AuditScene& scene) const {
    BidirectionalOptions options;
    options.limits = scene.limits;
    return target_ == Space::Path ? makePathTarget(scene.scene, options, *importance_)
                                  : makePrimaryTarget(scene.scene, options, *importance_);
}

std::vector<std::string> partnersOf(const std::string& mutation, Space target) {
    std::vector<std::string> names;
    for (const auto* entry : Registry<Mutation>::instance().entries()) {
        const auto made = entry->create(JsonNode(Json{{"type", entry->name}}));
        if (entry->name != mutation && (target == Space::Path || made->space() == Space::Primary))
            names.push_back(entry->name);
    }
    return names;
}

States drawStates(const AuditScene& scene, const Subject& subject, RandomKey key, uint64_t samples, size_t count) {
    const auto target = subject.makeTarget(scene);
    const auto seed = [&](uint64_t i, Sample& x) {
        Random random = randomOf(key, Stream::Bootstrap, i);
        return target->seed(random, randomOf(key, Stream::Choice, i)(), x);
    };
    States states;
    std::vector<uint64_t> suitable;
    std::vector<double> weights;
    std::map<std::string, std::vector<uint64_t>> byClass;
    std::array<uint64_t, 2> ends{};  // a shortest and a longest path
    std::array<bool, 2> found{};
    Sample x;
    for (uint64_t i = 0; i < samples; ++i) {
        Random random = randomOf(key, Stream::Bootstrap, i);
        const double w = target->bootstrapWeight(random);
        if (!(w > 0) || !seed(i, x)) continue;
        ++states.positive;
        if (!(subject.mutation().suitability(x) > 0)) continue;
        suitable.push_back(i);
        weights.push_back(w);
        byClass[pathClass(x.path)].push_back(i);
        for (size_t end : {0u, 1u})
            if (!found[end] && x.path.length() == (end == 0 ? 1 : scene.limits.maxDepth))
                ends[end] = i, found[end] = true;
    }
    states.drawn = samples;
    states.suitable = suitable.size();
    if (suitable.empty()) return states;

    std::vector<uint64_t> chosen;
    for (size_t end : {0u, 1u})
        if (found[end]) chosen.push_back(ends[end]);
    const DiscreteDistribution byWeight(weights);
    const size_t half = (count + 1) / 2, resampled = chosen.size() + half;
    for (size_t n = 0; chosen.size() < std::min(count, resampled); ++n) {
        double u = (double(n) + 0.5) / double(half);
        chosen.push_back(suitable[byWeight.sample(u)]);
    }
    for (size_t turn = 0; chosen.size() < count; ++turn)
        for (const auto& [name, members] : byClass)
            if (chosen.size() < count) chosen.push_back(members[turn % members.size()]);
    for (uint64_t i : chosen)
        if (seed(i, x)) states.x.push_back(x), states.source.push_back(i);
    return states;
}

std::string pathClass(const Path& path) {
    std::string text;
    for (int i = 0; i < path.size(); ++i) {
        const Vertex& v = path[i];
        text += v.onSurface() ? "SRTN"[int(v.lobe)] : "SLPID"[int(v.kind)];
    }
    return text;
}

}  // namespace ulam::audit
