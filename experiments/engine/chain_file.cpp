#include "experiments/engine/chain_file.h"

#include <bit>

#include "core/base/file.h"

namespace ulam {
namespace {

constexpr const char* kFile = "chains.npy";

std::vector<std::vector<ChainTrace::Draw>> keptDraws(const std::vector<ChainTrace>& traces) {
    const std::size_t kept = std::min(traces.size(), kKeptChains);
    std::vector<const ChainTrace*> chosen;
    for (std::size_t i = 0; i < kept; ++i) chosen.push_back(&traces[i * traces.size() / kept]);
    return drawsAtSameTurns(chosen);
}

/// Magic string, version, length, a Python dictionary padded so that the data begin at a multiple of 64 bytes.
std::string npyHeader(std::size_t chains, std::size_t draws) {
    static_assert(std::endian::native == std::endian::little);
    std::string text = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}, {}), }}", chains, draws,
                                   ChainTrace::kScalars);
    constexpr std::size_t kBefore = 10;
    text.append(63 - (kBefore + text.size()) % 64, ' ');
    text += '\n';
    const auto length = static_cast<std::uint16_t>(text.size());
    return std::string("\x93NUMPY\x01\x00", 8) + char(length & 0xff) + char(length >> 8) + text;
}

}  // namespace

Json chainFileJson(const std::vector<ChainTrace>& traces) {
    const auto draws = keptDraws(traces);
    if (draws.empty() || draws[0].empty()) return nullptr;
    return {{"file", kFile}, {"chains", draws.size()}, {"draws", draws[0].size()}, {"scalars", ChainTrace::kNames}};
}

void writeChains(const std::filesystem::path& folder, const std::vector<ChainTrace>& traces) {
    const auto draws = keptDraws(traces);
    if (draws.empty() || draws[0].empty()) return;
    std::string bytes = npyHeader(draws.size(), draws[0].size());
    for (const auto& own : draws)
        bytes.append(reinterpret_cast<const char*>(own.data()), own.size() * sizeof(ChainTrace::Draw));
    writeFileAtomically(folder / kFile, bytes);
}

}  // namespace ulam
