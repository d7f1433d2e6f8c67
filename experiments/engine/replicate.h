#pragma once
// One replicate of a task: rendered, or found finished.

#include <filesystem>

#include "experiments/engine/plan.h"
#include "experiments/engine/result.h"

namespace ulam {

/// FOLDER/r007
std::filesystem::path replicateFolder(const std::filesystem::path& taskFolder, int replicate);

/// The result.json of a finished replicate, or null. Finished means: complete, and made by this very task.
Json finishedReplicate(const Task& task, int replicate, const std::filesystem::path& taskFolder);

/// Renders a replicate and writes its folder. Returns false where a signal stopped it: then nothing is written.
bool renderReplicate(const Task& task, int replicate, const std::filesystem::path& taskFolder, int threads,
                     const std::atomic<bool>& interrupt, const std::function<void(double)>& progress);

}  // namespace ulam
