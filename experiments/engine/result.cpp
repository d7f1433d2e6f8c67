#include "experiments/engine/result.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/fixed_sum.h"
#include "core/base/memory.h"
#include "core/base/sha256.h"
#include "core/mcmc/mutation_mix.h"
#include "experiments/engine/chain_file.h"
#include "experiments/engine/mixing.h"
#include "experiments/engine/path_token.h"
#include "experiments/engine/provenance.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

Json mutationJson(const MutationStatistics& m) {
    Json rejected = Json::object();
    for (int reason = 1; reason < kRejectReasons; ++reason)
        if (m.rejected[reason] > 0) rejected[name(Reject(reason))] = m.rejected[reason];
    return {{"proposed", m.proposed}, {"accepted", m.accepted},
            {"zero", m.zero},         {"rejected", rejected},
            {"seconds", m.seconds},   {"esjd_pixels", m.proposed ? m.squaredJump / double(m.proposed) : 0}};
}

std::string snapshotFile(std::size_t index) {
    return fmt::format("snapshots/s{:02}.exr", index);
}

/// Scene, sampler and budget that make the same image again, whatever ended the run.
Json repetition(const RunIdentity& run, const RenderResult& result) {
    Json sampler = run.parameters;
    // What a time budget allowed.
    if (sampler.contains("bootstrap")) sampler["bootstrap"] = result.statistics.diagnostics["bootstrap_samples"];
    const double pixels = double(result.image.width) * result.image.height;
    return {{"scene", run.source},
            {"sampler", sampler},
            {"budget", result.statistics.chains > 0 ? Json{{"mutations", result.units}}
                                                    : Json{{"spp", double(result.units) / pixels}}}};
}

}  // namespace

Json sceneSource(const Json& scene, const fs::path& folder, const Json& film) {
    return {{"scene", scene}, {"folder", (fs::current_path() / folder).lexically_normal().string()}, {"film", film}};
}

Json resolveSampler(const JsonNode& sampler) {
    const JsonNode type = sampler.at("type");
    Json resolved = {{"type", type.string()}};
    resolved.update(Registry<Sampler>::instance().find(type.string(), type).resolve(sampler));
    // A sampler takes its mix as it is written; every sampler with one calls it so.
    if (resolved.contains("mutations")) {
        const auto written = sampler.find("mutations");
        resolved["mutations"] = MutationMix::resolve(written ? *written : JsonNode(resolved["mutations"]));
    }
    return resolved;
}

Json resultJson(const RunIdentity& run, const RenderResult& result, const Features& features) {
    const RenderStatistics& s = result.statistics;
    Json mutations = Json::object();
    for (const auto& [name, statistics] : s.mutationStatistics) mutations[name] = mutationJson(statistics);
    Json energy = Json::object(), jumps = Json::object();
    for (std::size_t i = 0; i < std::min(features.names.size(), s.featureEnergy.size()); ++i)
        energy[features.names[i]] = s.featureEnergy[i];
    for (std::size_t i = 0; i < std::min(features.names.size(), s.featureJumps.size()); ++i)
        jumps[features.names[i]] = s.featureJumps[i];
    const Json repeat = repetition(run, result);
    Json nonFinite = Json::array();
    for (const NonFiniteEvent& event : s.nonFinite.first())
        nonFinite.push_back({{"cause", event.cause}, {"token", pathToken(run, repeat, event)}});
    Json snapshots = Json::array();
    for (std::size_t i = 0; i < result.snapshots.size(); ++i) {
        const Snapshot& shot = result.snapshots[i];
        snapshots.push_back({{"fraction", shot.fraction},
                             {"seconds", shot.seconds},
                             {"rays", shot.rays},
                             {"samples", shot.samples},
                             {"mutations", shot.mutations},
                             {"image", snapshotFile(i)}});
    }
    return {
        {"schema_version", 1},
        {"scene", run.scene},
        {"scene_hash", run.sceneHash},
        {"sampler", run.sampler},
        {"parameters", run.parameters},
        {"seed", run.seed},
        {"replicate", run.replicate},
        {"random_key", {run.key.low, run.key.high}},
        {"threads", run.threads},
        {"sessions", result.sessions},
        {"checkpoint_seconds", result.checkpointSeconds},
        {"preview_seconds", result.previewSeconds},
        {"wall_seconds", result.wallSeconds},
        {"cpu_seconds", result.cpuSeconds},
        {"setup_seconds", run.setupSeconds},
        {"seeding_seconds", s.seedingSeconds},
        {"units", result.units},
        {"rays", s.rays},
        {"samples", s.samples},
        {"mutations", s.mutations},
        {"chains", s.chains},
        {"unsampled_pixels", s.unsampledPixels},
        {"normalization", s.normalization},
        {"normalization_std_error", s.normalizationStandardError},
        {"mutation_statistics", mutations},
        {"feature_energy", energy},
        {"feature_jumps", jumps},
        {"non_finite", s.nonFinite.counts()},
        {"non_finite_first", std::move(nonFinite)},
        {"bias_ledger", s.biasLedger},
        {"diagnostics", s.diagnostics},
        {"repeat", repeat},
        {"mixing", mixing(s.traces, result.wallSeconds, run.threads)},
        {"snapshots", snapshots},
        {"width", result.image.width},
        {"height", result.image.height},
        {"estimated_memory_bytes", expectedPeakBytes()},
        {"peak_rss_bytes", peakResidentBytes()},
        {"image_sha256", imageHash(result.image)},
        {"interrupted", result.interrupted},
        {"program_version", programVersion()},
        {"code_sha256", codeHash()},
        {"host", hostName()},
        {"processor", processorName()},
        {"simd", simd()},
    };
}

ImageAttributes imageAttributes(const RunIdentity& run) {
    return {{"ulam:version", programVersion()},      {"ulam:scene", run.scene},
            {"ulam:scene_hash", run.sceneHash},      {"ulam:sampler", run.parameters.dump()},
            {"ulam:seed", std::to_string(run.seed)}, {"ulam:replicate", std::to_string(run.replicate)}};
}

bool isBlack(const Image& image) {
    const auto black = [](const Rgb& p) { return p.x == 0 && p.y == 0 && p.z == 0; };
    return std::all_of(image.pixels.begin(), image.pixels.end(), black);
}

std::vector<std::string> warningsOf(const RunIdentity& run, const RenderResult& result) {
    std::vector<std::string> warnings;
    const NonFiniteLog& log = result.statistics.nonFinite;
    for (const auto& [cause, count] : log.counts()) {
        warnings.push_back(fmt::format("{} samples or steps met a value that is not finite, or beyond {:g}, and left it out: {}",
                                       count, FixedSum::kLargestTerm, cause));
        const auto first = std::find_if(log.first().begin(), log.first().end(), [&, &name = cause](const auto& e) { return e.cause == name; });
        if (first != log.first().end())
            warnings.back() += fmt::format("\n    see the first: ulam replay-path {}", pathToken(run, repetition(run, result), *first));
    }
    return warnings;
}

void refuseBlackImage(const RunIdentity& run, const RenderResult& result) {
    if (!isBlack(result.image)) return;
    for (const std::string& warning : warningsOf(run, result)) fail(ExitCode::InvalidConfig, "the image is black: {}", warning);
    if (result.units == 0) fail(ExitCode::InvalidConfig, "the budget was spent before the first sample or mutation was made");
    fail(ExitCode::InvalidConfig,
         "no path carried light: all of {} samples and mutations found nothing. Is the camera inside a wall or "
         "looking away, does nothing emit, is max_depth too small (1 shows emitters only), or the budget?",
         std::max(result.units, result.statistics.samples));
}

std::string imageHash(const Image& image) {
    std::string bytes = fmt::format("{} {} ", image.width, image.height);
    bytes.append(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(Rgb));
    return sha256(bytes);
}

Image readRecordedImage(const fs::path& file, const JsonNode& hash) {
    Image image = readImage(file);
    if (imageHash(image) != hash.string())
        hash.fail(fmt::format("{} is not the image that was written with the hash", file.string()));
    return image;
}

void makeFolder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) fail(ExitCode::CannotWrite, "cannot make the folder {}: {}", folder.string(), error.message());
}

void writeRun(const fs::path& folder, const RunIdentity& run, const RenderResult& result, const Json& resultFields) {
    makeFolder(folder);
    const ImageAttributes attributes = imageAttributes(run);
    if (!result.snapshots.empty()) makeFolder(folder / "snapshots");
    for (std::size_t i = 0; i < result.snapshots.size(); ++i)
        writeExr(folder / snapshotFile(i), result.snapshots[i].image, attributes);
    if (!result.statistics.extraImages.empty()) makeFolder(folder / "extra");
    for (const auto& [name, image] : result.statistics.extraImages)
        writeExr(folder / "extra" / (name + ".exr"), image, attributes);
    writeExr(folder / "image.exr", result.image, attributes);
    writeChains(folder, result.statistics.traces);
    writeFileAtomically(folder / "result.json", dump(resultFields) + "\n");
}

}  // namespace ulam
