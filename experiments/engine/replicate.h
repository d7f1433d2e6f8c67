#pragma once
// One replicate of a task: rendered, or found finished.

#include <filesystem>
#include <optional>
#include <string>

#include "experiments/engine/plan.h"
#include "experiments/engine/result.h"

namespace ulam {

/// FOLDER/r007
std::filesystem::path replicateFolder(const std::filesystem::path& taskFolder, int replicate);

/// Where an unfinished replicate keeps its state.
std::filesystem::path checkpointFile(const std::filesystem::path& taskFolder, int replicate);

struct FinishedReplicate {
    Json result;  ///< result.json; what the analysis reads of it is there and of its type
    Image image;
};

/// A finished replicate, or nothing. Finished means: made by this very task, complete, and every image is what was
/// written. `damage` says what is wrong with one that is there and is none of another task. Throws UnreadableFile: what
/// cannot be read now may be in order.
std::optional<FinishedReplicate> finishedReplicate(const Task& task, int replicate,
                                                   const std::filesystem::path& taskFolder,
                                                   std::string* damage = nullptr);

/// Renders with the task's budget and snapshots; key, threads and the rest are in the options.
RenderResult renderTask(const Task& task, RenderOptions options);

/// Writes the folder of a replicate.
void writeReplicate(const Task& task, int replicate, const std::filesystem::path& taskFolder, int threads,
                    const RenderResult& result);

/// Renders a replicate and writes its folder, unless another process has finished it in the meantime. Returns false where
/// a signal stopped it: then nothing is written.
bool renderReplicate(const Task& task, int replicate, const std::filesystem::path& taskFolder, int threads,
                     const std::atomic<bool>& interrupt, const std::function<void(double)>& progress,
                     const std::optional<PreviewPlan>& preview = {});

/// Why a replicate or a reference failed: FOLDER/failed.json, there until it succeeds or is tried again.
struct FailureRecord {
    std::string message, host;
    std::string time;  ///< UTC
};
void recordFailure(const std::filesystem::path& folder, const std::string& message);
std::optional<FailureRecord> recordedFailure(const std::filesystem::path& folder);
void forgetFailure(const std::filesystem::path& folder);

}  // namespace ulam
