#include "experiments/engine/mixing.h"

#include "experiments/statistics/chains.h"

namespace ulam {
namespace {

// Neighbouring chains come from neighbouring bootstrap samples, often the same one.
constexpr size_t kChainsPerSuperchain = 10;
constexpr size_t kShortestTrace = 8;

Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(); }

}  // namespace

Json mixing(const std::vector<ChainTrace>& traces, double seconds) {
    size_t length = traces.empty() ? 0 : traces[0].draws().size();
    for (const ChainTrace& t : traces) length = std::min(length, t.draws().size());
    if (length < kShortestTrace) return nullptr;
    const size_t chains = traces.size() / kChainsPerSuperchain * kChainsPerSuperchain;
    Json out = Json::object();
    out["draws_per_chain"] = length;
    for (int scalar = 0; scalar < ChainTrace::kScalars; ++scalar) {
        std::vector<statistics::Trace> values(traces.size(), statistics::Trace(length));
        for (size_t c = 0; c < traces.size(); ++c)
            for (size_t i = 0; i < length; ++i) values[c][i] = double(traces[c].draws()[i][size_t(scalar)]);
        const double size = statistics::effectiveSampleSize(values);
        Json entry = {{"split_rhat", finite(statistics::splitRhat(values))}, {"ess", finite(size)}, {"ess_per_second", finite(size / seconds)}};
        entry["nested_rhat"] =
            chains < 2 * kChainsPerSuperchain ? Json() : finite(statistics::nestedRhat(std::span(values).first(chains), kChainsPerSuperchain));
        out[ChainTrace::kNames[scalar]] = entry;
    }
    return out;
}

}  // namespace ulam
