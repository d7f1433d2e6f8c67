#include "experiments/engine/replicate.h"

#include <unistd.h>

#include "core/base/file.h"
#include "core/base/file_lock.h"
#include "experiments/engine/chain_file.h"
#include "experiments/engine/provenance.h"

namespace ulam {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFailureFile = "failed.json";

/// What the analysis reads is there and is a number. Fails with InvalidConfig where it is not.
void checkNumbers(const JsonNode& result) {
    for (const char* field : {"wall_seconds", "cpu_seconds", "setup_seconds", "seeding_seconds", "rays", "samples",
                              "mutations", "chains", "normalization"})
        result.at(field).number();
    for (const auto& [feature, energy] : result.at("feature_energy").members()) energy.number();
    for (const auto& [feature, count] : result.at("feature_jumps").members()) count.unsignedInteger();
    for (const auto& [cause, count] : result.at("non_finite").members()) count.unsignedInteger();
    for (const auto& [mutation, statistics] : result.at("mutation_statistics").members()) {
        for (const char* count : {"proposed", "accepted", "zero"}) statistics.at(count).unsignedInteger();
        for (const char* field : {"seconds", "esjd_pixels"}) statistics.at(field).number();
        for (const auto& [reason, count] : statistics.at("rejected").members()) count.unsignedInteger();
    }
}

/// As many as the task asks for, each as large as the image.
void checkSnapshots(const Task& task, const JsonNode& snapshots, const fs::path& folder, const Image& image) {
    const std::vector<JsonNode> shots = snapshots.elements();
    if (shots.size() != std::size_t(task.snapshots)) snapshots.expected(fmt::format("{} snapshots", task.snapshots));
    for (const JsonNode& shot : shots) {
        for (const char* field : {"fraction", "seconds", "rays", "samples", "mutations"}) shot.at(field).number();
        const fs::path file = folder / shot.at("image").string();
        const Image stored = readImage(file);
        if (stored.width != image.width || stored.height != image.height)
            fail(ExitCode::InvalidConfig, "{}: expected {} x {} pixels as of the final image, found {} x {}",
                 file.string(), image.width, image.height, stored.width, stored.height);
    }
}

RunIdentity identityOf(const Task& task, int replicate, int threads) {
    RunIdentity run;
    run.scene = task.scene->name;
    run.sceneHash = task.scene->hash;
    run.sampler = task.sampler;
    run.parameters = task.parameters;
    run.seed = task.seed;
    run.replicate = replicate;
    run.key = task.key(replicate);
    run.threads = threads;
    run.setupSeconds = task.scene->setupSeconds;
    run.source = task.scene->source;
    return run;
}

}  // namespace

fs::path replicateFolder(const fs::path& taskFolder, int replicate) {
    return taskFolder / fmt::format("r{:03}", replicate);
}

fs::path checkpointFile(const fs::path& taskFolder, int replicate) {
    return replicateFolder(taskFolder, replicate) / "checkpoint";
}

std::optional<FinishedReplicate> finishedReplicate(const Task& task, int replicate, const fs::path& taskFolder,
                                                   std::string* damage) {
    const fs::path folder = replicateFolder(taskFolder, replicate);
    std::error_code ignored;
    if (!fs::exists(folder / "result.json", ignored)) return {};
    try {
        const JsonDocument document = JsonDocument::fromFile(folder / "result.json");
        const JsonNode result = document.root();
        const bool matches =
            result.at("task_hash").string() == task.hash() && result.at("replicate").integer() == replicate;
        if (!matches) return {};
        checkNumbers(result);
        FinishedReplicate finished{result.json(), readRecordedImage(folder / "image.exr", result.at("image_sha256"))};
        checkSnapshots(task, result.at("snapshots"), folder, finished.image);
        return finished;
    } catch (const UnreadableFile&) {
        throw;
    } catch (const Error& error) {
        if (damage) *damage = error.what();
        return {};
    }
}

void writeReplicate(const Task& task, int replicate, const fs::path& taskFolder, int threads,
                    const RenderResult& result) {
    const RunIdentity run = identityOf(task, replicate, threads);
    Json fields = resultJson(run, result, task.scene->features);
    fields["budget"] = budgetJson(task.budget);
    fields["task_hash"] = task.hash();
    fields["traces"] = chainFileJson(result.statistics.traces);
    writeRun(replicateFolder(taskFolder, replicate), run, result, fields);
}

RenderResult renderTask(const Task& task, RenderOptions options) {
    options.budget = task.budget;
    options.snapshots = task.snapshots;
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(task.parameters));
    return render(*task.scene->scene(), *sampler, options);
}

bool renderReplicate(const Task& task, int replicate, const fs::path& taskFolder, int threads,
                     const std::atomic<bool>& interrupt, const std::function<void(double)>& progress,
                     const std::optional<PreviewPlan>& preview) {
    RenderOptions options;
    options.key = task.key(replicate);
    options.threads = threads;
    options.progress = progress;
    options.interrupt = &interrupt;
    options.preview = preview;
    options.checkpoint = CheckpointPlan{.file = checkpointFile(taskFolder, replicate),
                                        .identity = {{"task", task.hash()}, {"replicate", replicate}, {"code", codeHash()}},
                                        .resume = Resume::IfUsable};
    makeFolder(replicateFolder(taskFolder, replicate));
    const RenderResult result = renderTask(task, options);
    if (result.interrupted) return false;
    {
        // A process that was held up may have lost its work to another: the files that stay are of one of them.
        const FileLock lock = FileLock::await(replicateFolder(taskFolder, replicate));
        if (!finishedReplicate(task, replicate, taskFolder))
            writeReplicate(task, replicate, taskFolder, threads, result);
    }
    std::error_code ignored;
    fs::remove(options.checkpoint->file, ignored);
    return true;
}

void recordFailure(const fs::path& folder, const std::string& message) {
    makeFolder(folder);
    writeFileAtomically(folder / kFailureFile, dump({{"schema_version", 1},
                                                     {"message", message},
                                                     {"host", hostName()},
                                                     {"process", ::getpid()},
                                                     {"time", utcNow()}}) +
                                                   "\n");
}

std::optional<FailureRecord> recordedFailure(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::exists(folder / kFailureFile, ignored)) return {};
    try {
        const JsonDocument document = JsonDocument::fromFile(folder / kFailureFile);
        return FailureRecord{document.root().at("message").string(), document.root().at("host").string(),
                             document.root().at("time").string()};
    } catch (const Error& error) {
        return FailureRecord{error.what(), "", ""};
    }
}

void forgetFailure(const fs::path& folder) {
    std::error_code ignored;  // what cannot be removed cannot be written either, which says so
    fs::remove(folder / kFailureFile, ignored);
}

}  // namespace ulam
