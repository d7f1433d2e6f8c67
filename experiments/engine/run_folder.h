#pragma once
// What the folder of a run says of it to processes that did not begin it.

#include <filesystem>

#include "experiments/engine/plan.h"

namespace ulam {

/// A file that the program wrote: of any size, unlike those of users.
Json readOwnJson(const std::filesystem::path& file);

/// The plan, made again from experiment.json. Relative paths in it start where the experiment's file was. Fails with
/// InputMissing where the folder holds no run, and with InvalidConfig where this program plans other tasks or
/// references than resolved.json names, saying which and why.
Plan planOfRun(const std::filesystem::path& runDir);

/// Where an experiment's "until" has added replicates since the plan was made: adds them to it and returns them.
std::vector<Plan::Replicate> addedReplicates(Plan& plan, const std::filesystem::path& runDir);

/// What is done, who works at what, what has failed and what is missing, of each reference and cell and in all: what
/// `ulam status --json` prints. It reads resolved.json and results, makes no plan, and does not look into images.
Json statusOfRun(const std::filesystem::path& runDir);

}  // namespace ulam
