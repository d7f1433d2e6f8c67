#pragma once
// A run folder as the engine leaves it, made up: 2 scenes × 3 samplers, each with the fault the report must show.
// bdpt is noisy and right, pssmlt blotchy, mlt smooth with every hole's brightness wrong.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/config/json.h"
#include "core/image/image_io.h"

namespace ulam::tests {

struct FakeSampler {
    std::string name;
    double pixelNoise;  // relative standard deviation of a pixel
    double holeSpread;  // standard deviation of the log brightness of a hole
    bool chains;
};

class FakeRun {
public:
    FakeRun(std::filesystem::path folder, int size, int holes, int replicates)
        : folder_(std::move(folder)), size_(size), holes_(holes), replicates_(replicates) {}

    void write() {
        Json cells = Json::array(), comparisons = Json::array(), verdicts = Json::array();
        for (const auto& [scene, spot] : {std::pair{"hidden", 0.30}, std::pair{"emitter", 0.42}}) {
            const Image reference = picture(spot, std::vector<double>(std::size_t(holes_ * holes_), 1.0), 0);
            const std::string path = fmt::format("references/{}/image.exr", scene);
            writeImage(path, reference);
            writeImage(fmt::format("references/{}/variance.exr", scene), Image(size_, size_));
            const bool easy = std::string(scene) == "emitter";
            std::vector<double> errors;
            for (FakeSampler sampler : kSamplers) {
                if (easy) sampler.holeSpread *= 0.15;
                cells.push_back(writeCell(scene, spot, sampler, reference, path));
                errors.push_back(cells.back()["metrics"]["relmse"]["mean"].get<double>());
                if (!sampler.chains) continue;
                const double ratio = errors.back() / errors.front();
                const std::string verdict = easy && sampler.name == "pssmlt" ? "undecided"
                                            : ratio < 1                      ? "better"
                                                                             : "worse";
                const double p = verdict == "undecided" ? 0.21 : 1.6e-4;
                comparisons.push_back({{"scene", scene},
                                       {"sampler", sampler.name},
                                       {"baseline", "bdpt"},
                                       {"metric", "relmse"},
                                       {"ratio", ratio},
                                       {"ci95", {ratio * 0.86, ratio * 1.17}},
                                       {"speedup", 1 / ratio},
                                       {"speedup_ci95", {0.85 / ratio, nullptr}},
                                       {"p", p},
                                       {"p_adjusted", std::min(1.0, 4 * p)},
                                       {"verdict", verdict}});
                verdicts.push_back(fmt::format("{}’s relMSE is {:.2f} × bdpt’s (95 % {:.2f}–{:.2f}), p = {:.2g}: {}.",
                                               sampler.name, ratio, ratio * 0.86, ratio * 1.17, 4 * p, verdict));
            }
        }
        writeJson("summary.json",
                  {{"schema_version", 1},
                   {"name", "backlit_grid_of_holes"},
                   {"primary_metric", "relmse"},
                   {"cells", cells},
                   {"comparisons", comparisons},
                   {"tuning", tuning()},
                   {"verdicts", verdicts},
                   {"warnings", {"mlt on hidden: log errors are heavy-tailed, intervals may cover less than 95 %."}}});
        writeJson("experiment.json", {{"name", "backlit_grid_of_holes"},
                                      {"film", {{"width", size_}, {"height", size_}}},
                                      {"max_depth", 8},
                                      {"baseline", "bdpt"},
                                      {"budget", {{"time", 2}}},
                                      {"replicates", replicates_},
                                      {"note", "</script><b>"}});
        writeJson("provenance.json", {{"program", {{"version", "0.1.0"}, {"build", "release"}}},
                                      {"threads", 2},
                                      {"started", "2025-01-31T12:00:00Z"},
                                      {"command", "ulam run backlit_grid_of_holes.json"}});
    }

private:
    static inline const std::array<FakeSampler, 3> kSamplers{
        {{"bdpt", 1.1, 0.03, false}, {"pssmlt", 0.55, 0.32, true}, {"mlt", 0.12, 0.55, true}}};

    static constexpr int kChains = 16, kDraws = 64;
    static inline const std::array<std::pair<int, int>, 5> kTechniques{{{0, 3}, {1, 2}, {2, 1}, {1, 3}, {2, 2}}};

    double normal() {  // Box and Muller: the standard library's distribution differs between libraries
        const double u = (double(random_()) + 1) / 4294967296.0, v = double(random_()) / 4294967296.0;
        return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
    }

    void writeJson(const std::string& path, const Json& json) { writeBytes(path, json.dump(2)); }
    void writeBytes(const std::string& path, const std::string& bytes) {
        std::filesystem::create_directories((folder_ / path).parent_path());
        writeFileAtomically(folder_ / path, bytes);
    }
    void writeImage(const std::string& path, const Image& image) {
        std::filesystem::create_directories((folder_ / path).parent_path());
        writeExr((folder_ / path).string(), image);
    }

    /// A spot of light per hole, of the given relative brightness.
    Image picture(double spot, const std::vector<double>& brightness, double noise) {
        Image image(size_, size_);
        for (int y = 0; y < size_; ++y) {
            for (int x = 0; x < size_; ++x) {
                const double u = (x + 0.5) * holes_ / size_, v = (y + 0.5) * holes_ / size_;
                double value = 0.02;
                for (int row = std::max(0, int(v) - 1); row <= std::min(holes_ - 1, int(v) + 1); ++row)
                    for (int column = std::max(0, int(u) - 1); column <= std::min(holes_ - 1, int(u) + 1); ++column) {
                        const double d2 = std::pow(u - column - 0.5, 2) + std::pow(v - row - 0.5, 2);
                        value +=
                            brightness[std::size_t(row * holes_ + column)] * std::exp(-d2 / (2 * spot * spot * 0.36));
                    }
                if (noise > 0) value *= std::exp(noise * normal() - noise * noise / 2);
                image.at(x, y) = Rgb(float(value), float(0.92 * value), float(0.78 * value));
            }
        }
        return image;
    }

    static double relmse(const Image& image, const Image& reference) {
        double total = 0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            for (int c = 0; c < 3; ++c)
                total += std::pow(image.pixels[i][c] - reference.pixels[i][c], 2) /
                         (std::pow(reference.pixels[i][c], 2) + 0.01);
        return total / (3 * double(image.pixels.size()));
    }

    Json writeCell(const std::string& scene, double spot, const FakeSampler& sampler, const Image& reference,
                   const std::string& referencePath) {
        const std::string cell = scene + "-" + sampler.name;
        const auto n = std::size_t(holes_ * holes_), runs = std::size_t(replicates_);
        std::vector<double> errors;
        std::vector<std::vector<double>> shares(n, std::vector<double>(runs));
        for (std::size_t r = 0; r < runs; ++r) {
            std::vector<double> brightness(n);
            double total = 0;
            for (double& b : brightness) total += b = std::exp(sampler.holeSpread * normal());
            for (double& b : brightness) b *= double(n) / total;
            if (sampler.name == "mlt" && scene == "hidden" && r == 2) brightness[n / 3] = 4.2, brightness[n / 2] = 0;
            for (std::size_t h = 0; h < n; ++h) shares[h][r] = brightness[h] / double(n);
            const Image image = picture(spot, brightness, sampler.pixelNoise);
            errors.push_back(relmse(image, reference));
            writeImage(fmt::format("cells/{}/r{:03}/image.exr", cell, r), image);
            if (!sampler.chains) continue;
            // After the first half: of mlt, whose chains stay, the same holes; of others, other ones.
            std::swap(random_, randomOfHalves_);
            if (sampler.name != "mlt")
                for (double& b : brightness) b = std::exp(sampler.holeSpread * normal());
            writeImage(fmt::format("cells/{}/r{:03}/snapshots/s00.exr", cell, r), picture(spot, brightness, sampler.pixelNoise));
            std::swap(random_, randomOfHalves_);
        }
        for (std::size_t r = 0; r < runs; ++r) writeReplicate(fmt::format("cells/{}/r{:03}", cell, r), scene, sampler, reference);
        std::vector<double> sorted = errors;
        std::sort(sorted.begin(), sorted.end());
        const auto rankOf = [&](double value) {
            return std::size_t(std::find(errors.begin(), errors.end(), value) - errors.begin());
        };
        double mean = 0;
        for (const double e : errors) mean += e / double(runs);

        Json json = {
            {"cell", cell},
            {"scene", scene},
            {"sampler", sampler.name},
            {"replicates", replicates_},
            {"metrics",
             {{"relmse",
               {{"mean", mean},
                {"ci95", {mean * 0.9, mean * 1.11}},
                {"trimmed_mean", mean * 0.83},
                {"worst_replicate", sorted.back()},
                {"values", errors}}},
              {"mape", {{"mean", std::sqrt(mean) * 0.6}, {"ci95", {std::sqrt(mean) * 0.57, std::sqrt(mean) * 0.63}}}},
              {"flip", {{"mean", std::sqrt(mean) * 0.3}, {"ci95", {std::sqrt(mean) * 0.28, std::sqrt(mean) * 0.32}}}}}},
            {"variance", mean * 0.9},
            {"bias_squared", sampler.name == "bdpt" ? -2e-5 : mean * 0.02},
            {"seconds", 2.01},
            {"rays", 1.6e7},
            {"mutations", sampler.chains ? 2.4e6 : 0},
            {"normalization_cv", sampler.chains ? 0.031 : 0.0},
            {"convergence", convergence(sampler, mean)},
            {"slope",
             {{"value", slopeOf(sampler)},
              {"ci95", {slopeOf(sampler) - 0.06, slopeOf(sampler) + 0.06}},
              {"flatter_than_minus_one", slopeOf(sampler) > -0.9}}},
            {"error_spectrum", spectrum(sampler)},
            {"features", features(shares, sampler)},
            {"feature_grid", {holes_, holes_}},
            {"reference", "references/" + scene},
            {"reference_image", referencePath},
            {"reference_too_poor", scene == "emitter" && sampler.name == "mlt"},
            {"warnings", Json::array()},
            {"worst_replicate", rankOf(sorted.back())},
            {"median_replicate", rankOf(sorted[runs / 2])}};
        if (sampler.name == "pssmlt")
            json["mutation_statistics"] = {{"large_step",
                                            {{"proposed", 5750000},
                                             {"accepted", 310000},
                                             {"zero", 5200000},
                                             {"rejected", {{"zero_target", 5200000}}},
                                             {"seconds", 5.1},
                                             {"esjd_pixels", 310.2}}},
                                           {"small_step",
                                            {{"proposed", 13450000},
                                             {"accepted", 8200000},
                                             {"zero", 2100000},
                                             {"rejected", {{"zero_target", 2100000}}},
                                             {"seconds", 10.2},
                                             {"esjd_pixels", 2.4}}}};
        if (sampler.name == "mlt")
            json["mutation_statistics"] = {
                {"bidirectional",
                 {{"proposed", 9600000},
                  {"accepted", 210000},
                  {"zero", 0},
                  {"rejected", {{"occluded", 6100000}, {"missed", 2200000}, {"zero_target", 700000}}},
                  {"seconds", 8.1},
                  {"esjd_pixels", 52.0}}},
                {"lens",
                 {{"proposed", 3200000},
                  {"accepted", 1900000},
                  {"zero", 0},
                  {"rejected", {{"off_screen", 400000}, {"occluded", 600000}}},
                  {"seconds", 2.2},
                  {"esjd_pixels", 8.4}}},
                {"caustic",
                 {{"proposed", 3200000},
                  {"accepted", 1200000},
                  {"zero", 0},
                  {"rejected", {{"off_screen", 300000}, {"occluded", 1500000}}},
                  {"seconds", 2.4},
                  {"esjd_pixels", 6.9}}},
                {"multi_chain",
                 {{"proposed", 3200000},
                  {"accepted", 400000},
                  {"zero", 0},
                  {"rejected", {{"not_invertible", 1900000}, {"occluded", 700000}}},
                  {"seconds", 2.9},
                  {"esjd_pixels", 3.1}}}};
        return json;
    }

    /// Four candidates, of which two had a second round, and the last was best.
    static Json tuning() {
        Json candidates = Json::array();
        for (const int chains : {10, 100, 1000, 10000})
            candidates.push_back({{"values", {{"samplers.mlt.chains", chains}, {"samplers.mlt.target", "max"}}},
                                  {"scores", Json::array({-1 - std::log10(chains)})}});
        for (const std::size_t kept : {2u, 3u}) candidates[kept]["scores"].push_back(kept == 3 ? -7 : -6);
        const Json first = {{"candidates", 4}, {"budget", {{"time", 1}}}, {"replicates", 4}, {"kept", {3, 2}}};
        const Json second = {{"candidates", 2}, {"budget", {{"time", 2}}}, {"replicates", 4}, {"kept", Json::array({3})}};
        return {{"sampler", "mlt"},
                {"candidates", candidates},
                {"rounds", {first, second}},
                {"winner", candidates[3]["values"]}};
    }

    static Json trappedFeature() {
        return {{"split_rhat", 4.2},
                {"ess", 51.0},
                {"integrated_autocorrelation_mutations", 4321.0},
                {"integrated_autocorrelation_bound", "lower"}};
    }

    /// What a replicate leaves beside its image: of bdpt the images of its techniques, of others their chains.
    void writeReplicate(const std::string& folder, const std::string& scene, const FakeSampler& sampler,
                        const Image& reference) {
        Json result = {{"schema_version", 1},
                       {"scene", scene},
                       {"sampler", sampler.name},
                       {"seed", 1},
                       {"width", size_},
                       {"height", size_},
                       {"non_finite", 0},
                       {"bias_ledger", sampler.name == "pssmlt" ? Json::array({"normalisation refined by large steps"})
                                                                : Json::array()},
                       {"image_sha256", std::string(64, 'a')}};
        if (sampler.chains) {
            const Json scalars = {"raster_x", "raster_y", "log_target", "path_length", "feature"};
            result.update(
                {{"chains", 100},
                 {"mutations", 2.4e6},
                 {"normalization", 0.5},
                 {"snapshots", Json::array({{{"mutations", 1.2e6}, {"image", "snapshots/s00.exr"}}})},
                 {"mixing", {{"draws_per_chain", kDraws}, {"mutations_per_draw", 64}, {"feature", trappedFeature()}}},
                 {"traces", {{"file", "chains.npy"}, {"chains", kChains}, {"draws", kDraws}, {"scalars", scalars}}}});
            writeBytes(folder + "/chains.npy", chains(sampler));
            Image proposed(size_, size_, Rgb(100)), accepted(size_, size_);
            for (int y = 0; y < size_; ++y)
                for (int x = 0; x < size_; ++x) accepted.at(x, y) = Rgb(float(100 * x / size_));
            writeImage(folder + "/extra/proposed.exr", proposed);
            writeImage(folder + "/extra/accepted.exr", accepted);
        } else {
            for (const auto& [s, t] : kTechniques)
                for (const char* kind : {"weighted", "unweighted"}) {
                    Image image = reference;
                    for (Rgb& pixel : image.pixels) pixel *= float(kind[0] == 'w' ? s + 1 : 10) / 16;
                    writeImage(fmt::format("{}/extra/s{:02}_t{:02}_{}.exr", folder, s, t, kind), image);
                }
        }
        writeJson(folder + "/result.json", result);
    }

    /// A NumPy file of chains, each of which stays in one hole, but for pssmlt's, which go everywhere.
    std::string chains(const FakeSampler& sampler) {
        std::string header = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}, 5), }}", kChains, kDraws);
        header.append(117 - header.size(), ' ');
        std::string bytes = std::string("\x93NUMPY\x01\x00", 8) + char(header.size() + 1) + '\0' + header + '\n';
        for (int chain = 0; chain < kChains; ++chain)
            for (int draw = 0; draw < kDraws; ++draw) {
                const int hole = (sampler.name == "mlt" ? 7 * chain : 11 * chain + 5 * draw) % (holes_ * holes_);
                const double cell = double(size_) / holes_;
                const std::array<float, 5> values{float((hole % holes_ + 0.5 + 0.1 * normal()) * cell),
                                                  float((hole / holes_ + 0.5 + 0.1 * normal()) * cell), float(normal()),
                                                  float(2 + draw % 3), float(hole)};
                bytes.append(reinterpret_cast<const char*>(values.data()), sizeof values);
            }
        return bytes;
    }

    static double slopeOf(const FakeSampler& sampler) {
        return sampler.name == "mlt" ? -0.55 : sampler.name == "pssmlt" ? -0.94 : -1.01;
    }

    static Json convergence(const FakeSampler& sampler, double last) {
        Json points = Json::array();
        for (int i = 5; i >= 0; --i) {
            const double fraction = std::exp2(-i), error = last * std::pow(fraction, slopeOf(sampler));
            points.push_back({{"fraction", fraction},
                              {"seconds", 2 * fraction},
                              {"rays", 1.6e7 * fraction},
                              {"mutations", sampler.chains ? 2.4e6 * fraction : 0.0},
                              {"samples", 1e6 * fraction},
                              {"error", error},
                              {"ci95", {error * (0.9 - 0.03 * i), error * (1.11 + 0.05 * i)}}});
        }
        return points;
    }

    /// Flat noise, and of chains what neighbours share.
    Json spectrum(const FakeSampler& sampler) const {
        Json frequencies = Json::array(), density = Json::array(), low = Json::array(), high = Json::array(), counts = Json::array();
        for (int i = 0; i < 18; ++i) {
            const double frequency = std::exp2(i / 3.0 - 6) / 2, noise = sampler.pixelNoise * sampler.pixelNoise;
            const double value = noise + std::pow(sampler.holeSpread, 2) / (0.1 + std::pow(holes_ * frequency, 2));
            frequencies.push_back(frequency);
            density.push_back(value);
            low.push_back(value * 0.7);
            high.push_back(value * 1.4);
            counts.push_back(std::exp2(i / 1.5));
        }
        return {{"cycles_per_pixel", frequencies}, {"counts", counts}, {"density", density},
                {"low", low},                      {"high", high},     {"brightness", 0.01 * sampler.holeSpread}};
    }

    Json features(const std::vector<std::vector<double>>& shares, const FakeSampler& sampler) const {
        Json json = Json::object();
        const double truth = 1.0 / double(shares.size());
        for (std::size_t h = 0; h < shares.size(); ++h) {
            const auto runs = double(shares[h].size());
            double mean = 0, variance = 0;
            for (const double s : shares[h]) mean += s / runs;
            for (const double s : shares[h]) variance += (s - mean) * (s - mean) / (runs - 1);
            const double error = std::sqrt(variance / runs), t = std::abs(mean - truth) / error;
            json[fmt::format("hole_{}_{}", h / std::size_t(holes_), h % std::size_t(holes_))] = {
                {"share", mean},
                {"share_ci95", {mean - 2.4 * error, mean + 2.4 * error}},
                {"truth", truth},
                {"p_adjusted", std::min(1.0, 8 * std::exp(-0.5 * t * t))},
                {"relative_sd", std::sqrt(variance) / mean},
                {"jumps_per_million",
                 sampler.chains ? Json(sampler.name == "mlt" ? 40 + 9.0 * double(h % 7) : 900 + 50.0 * double(h % 5))
                                : Json()},
                {"per_replicate", shares[h]}};
        }
        return json;
    }

    std::filesystem::path folder_;
    int size_, holes_, replicates_;
    std::mt19937 random_{1};
    std::mt19937 randomOfHalves_{7};
};

}  // namespace ulam::tests
