#include "experiments/engine/mixing.h"

#include <algorithm>
#include <array>

#include "core/config/json_number.h"
#include "core/render/chain_run.h"
#include "core/render/parallel.h"
#include "experiments/statistics/chains.h"

namespace ulam {
namespace {

// Chains that started close to each other on the image, in the place of the common starting points of Margossian et al.:
// what sets such groups apart has not mixed.
constexpr size_t kChainsPerSuperchain = 10;
constexpr size_t kShortestTrace = 8;
// Of a correlation that falls exponentially the draws show a time that is 8 % too long where it is two draws long, and
// twice the time where it is half a draw.
constexpr double kShortestResolved = 2;

/// Place of a pixel along the Z-order curve, on which neighbours are neighbours in the image.
uint64_t zOrder(const Vec2f& raster) {
    const auto x = uint64_t(std::max(0.0f, raster.x)), y = uint64_t(std::max(0.0f, raster.y));
    uint64_t code = 0;
    for (int bit = 0; bit < 24; ++bit) code |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
    return code;
}

bool isConstant(const std::vector<statistics::Trace>& values) {
    return std::all_of(values.begin(), values.end(), [&](const statistics::Trace& trace) {
        return std::all_of(trace.begin(), trace.end(), [&](double v) { return v == values[0][0]; });
    });
}

using Draws = std::vector<std::vector<ChainTrace::Draw>>;  ///< by chain

/// Of an autocorrelation time, in draws, of chains of so many draws.
Json boundOf(double time, size_t length) {
    if (time < kShortestResolved) return "upper";
    return time > double(length) ? Json("lower") : Json();
}

Json mixingOf(size_t scalar, const Draws& draws, uint64_t mutationsPerDraw, double seconds) {
    std::vector<statistics::Trace> values;
    for (const auto& chain : draws) {
        values.emplace_back();
        for (const ChainTrace::Draw& draw : chain) values.back().push_back(double(draw[scalar]));
    }
    if (isConstant(values)) return {};  // such as the path length of states that are whole samples
    const size_t length = values[0].size();
    const double time = statistics::autocorrelationTime(values), size = double(values.size() * length) / time;
    const size_t chains = values.size() / kChainsPerSuperchain * kChainsPerSuperchain;
    return {{"split_rhat", numberOrNull(statistics::splitRhat(values))},
            {"ess", numberOrNull(size)},
            {"ess_per_second", numberOrNull(size / seconds)},
            {"integrated_autocorrelation_mutations", numberOrNull(time * double(mutationsPerDraw))},
            {"integrated_autocorrelation_bound", boundOf(time, length)},
            {"nested_rhat",
             chains < 2 * kChainsPerSuperchain
                 ? Json()
                 : numberOrNull(statistics::nestedRhat(std::span(values).first(chains), kChainsPerSuperchain))}};
}

}  // namespace

Json mixing(const std::vector<ChainTrace>& traces, double seconds, int threads) {
    std::vector<const ChainTrace*> sorted;
    for (const ChainTrace& t : traces) sorted.push_back(&t);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const ChainTrace* a, const ChainTrace* b) { return zOrder(a->origin()) < zOrder(b->origin()); });
    const Draws draws = drawsAtSameTurns(sorted);
    const size_t length = draws.empty() ? 0 : draws[0].size();
    if (length < kShortestTrace) return nullptr;
    const uint64_t mutationsPerDraw =
        std::ranges::max_element(traces, {}, &ChainTrace::stride)->stride() * ChainRun::kChunk;
    std::array<Json, ChainTrace::kScalars> found;
    forEachChunk(
        threads, 0, found.size(), 1, [](int) { return false; },
        [&](int, uint64_t scalar, uint64_t) { found[scalar] = mixingOf(scalar, draws, mutationsPerDraw, seconds); });
    Json out = Json::object();
    out["draws_per_chain"] = length;
    out["mutations_per_draw"] = mutationsPerDraw;
    for (size_t scalar = 0; scalar < found.size(); ++scalar)
        if (!found[scalar].is_null()) out[ChainTrace::kNames[scalar]] = std::move(found[scalar]);
    return out;
}

}  // namespace ulam
