#include "experiments/report/chain_data.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"

namespace ulam {
namespace {

constexpr std::size_t kScalars = 5;  // raster_x, raster_y, log_target, path_length, feature

/// The floats of an .npy file of version 1, of which only the length of the header is read: what it says is in
/// result.json.
std::vector<float> readFloats(const std::filesystem::path& file, std::size_t count) {
    const std::string bytes = readFile(file);
    const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(bytes[i])); };
    const std::size_t begin =
        bytes.starts_with("\x93NUMPY\x01") && bytes.size() > 10 ? 10 + byte(8) + 256 * byte(9) : 0;
    if (begin == 0 || bytes.size() != begin + 4 * count) {
        fail(ExitCode::InvalidConfig, "{}: expected a NumPy file of {} 32-bit floats, found {} bytes", file.string(),
             count, bytes.size());
    }
    std::vector<float> values(count);
    std::memcpy(values.data(), bytes.data() + begin, 4 * count);
    return values;
}

void append16(std::string& bytes, double fraction) {
    const auto word = unsigned(std::lround(65535 * std::clamp(fraction, 0.0, 1.0)));
    bytes.push_back(char(word & 255));
    bytes.push_back(char(word >> 8));
}

void append8(std::string& bytes, float value) {
    bytes.push_back(char(static_cast<unsigned char>(std::clamp(value, 0.0f, 255.0f))));
}

}  // namespace

std::optional<ChainData> readChainData(const std::filesystem::path& folder, const Json& result, int most) {
    const Json traces = result.value("traces", Json());
    if (!traces.is_object() || most < 1) return std::nullopt;
    const std::filesystem::path file = folder / traces.at("file").get<std::string>();
    if (!std::filesystem::exists(file)) return std::nullopt;
    const auto chains = traces.at("chains").get<std::size_t>(), draws = traces.at("draws").get<std::size_t>();
    const std::vector<float> values = readFloats(file, chains * draws * kScalars);

    const std::size_t kept = std::min(chains, std::size_t(most));
    const auto each = [&](std::size_t scalar, const auto& use) {
        for (std::size_t chain = 0; chain < kept; ++chain)
            for (std::size_t draw = 0; draw < draws; ++draw)
                use(values[(chain * chains / kept * draws + draw) * kScalars + scalar]);
    };
    double low = INFINITY, high = -INFINITY;
    each(2, [&](float v) {
        if (!std::isfinite(v)) return;
        low = std::min(low, double(v));
        high = std::max(high, double(v));
    });
    if (!(low < high)) low = std::isfinite(low) ? low - 0.5 : 0, high = low + 1;

    ChainData data;
    const double width = result.at("width").get<double>(), height = result.at("height").get<double>();
    each(0, [&](float v) { append16(data.bytes, v / width); });
    each(1, [&](float v) { append16(data.bytes, v / height); });
    each(2, [&](float v) { append16(data.bytes, std::isnan(v) ? 0 : (v - low) / (high - low)); });
    each(3, [&](float v) { append8(data.bytes, v); });
    each(4, [&](float v) { append8(data.bytes, v + 1); });
    data.fields = {{"chains", kept}, {"draws", draws}, {"log_target", {low, high}}};
    return data;
}

}  // namespace ulam
