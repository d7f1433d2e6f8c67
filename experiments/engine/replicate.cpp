#include "experiments/engine/replicate.h"

namespace ulam {

namespace fs = std::filesystem;

fs::path replicateFolder(const fs::path& taskFolder, int replicate) {
    return taskFolder / fmt::format("r{:03}", replicate);
}

Json finishedReplicate(const Task& task, int replicate, const fs::path& taskFolder) {
    const fs::path folder = replicateFolder(taskFolder, replicate);
    const fs::path file = folder / "result.json";
    if (!fs::exists(file) || !fs::exists(folder / "image.exr")) return nullptr;
    Json result;
    try {
        result = JsonDocument::fromFile(file).json();
    } catch (const Error&) {
        return nullptr;  // damaged: done again
    }
    const bool matches = result.is_object() && result.value("task_hash", "") == task.hash() &&
                         result.value("replicate", -1) == replicate;
    return matches ? result : Json();
}

bool renderReplicate(const Task& task, int replicate, const fs::path& taskFolder, int threads,
                     const std::atomic<bool>& interrupt, const std::function<void(double)>& progress) {
    RunIdentity run;
    run.scene = task.scene->name;
    run.sceneHash = task.scene->scene.hash;
    run.sampler = task.sampler;
    run.parameters = task.parameters;
    run.seed = task.seed;
    run.replicate = replicate;
    run.key = task.key(replicate);
    run.threads = threads;
    run.setupSeconds = task.scene->setupSeconds;

    RenderOptions options;
    options.budget = task.budget;
    options.key = run.key;
    options.threads = threads;
    options.snapshots = task.snapshots;
    options.progress = progress;
    options.interrupt = &interrupt;
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(task.parameters));
    const RenderResult result = render(task.scene->scene, *sampler, options);
    if (result.interrupted) return false;

    Json fields = resultJson(run, result, task.scene->scene.features);
    fields["budget"] = budgetJson(task.budget);
    fields["task_hash"] = task.hash();
    writeRun(replicateFolder(taskFolder, replicate), run, result, fields);
    return true;
}

}  // namespace ulam
