#pragma once
// Slurm: what a run lacks becomes job arrays, whose tasks run `ulam work --task` in the run's folder. Any task may end
// in any way, run twice or never: what it should have done is still missing then, and is submitted again when that is
// asked for.
//
// RUN_DIR/jobs/001/ holds one job array: tasks.json (what each of its tasks does), job.sh, N.log of task N, and, once
// it is submitted, job.json with its number.

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "experiments/engine/run.h"

namespace ulam {

struct SlurmOptions {
    double taskMinutes = 15;  ///< expected length of a task, as far as single replicates allow
    int cpusPerTask = 1;
    std::vector<std::string> sbatch;  ///< further options of sbatch: "--partition=short"
};

/// "slurm" or "slurm:KEY=VALUE,…": task-minutes, and options of sbatch by their long names, with or without a value.
/// Fails with Usage.
SlurmOptions parseSlurmOptions(const std::string& text);

struct JobArray {
    std::string job;   ///< number, as sbatch gave it
    std::string kind;  ///< "references", "cells", or "timed cells", which get their nodes for themselves
    std::size_t tasks = 0, replicates = 0;
    double seconds = 0;  ///< expected, of all tasks together
};

/// Submits what is neither finished, nor held by a process, nor waiting in the queue; what failed counts as missing.
/// The header of the run must be there. `workOptions`: further arguments of `ulam work`. Fails with InputMissing where
/// Slurm's commands cannot be run, and with Usage where sbatch refuses.
std::vector<JobArray> submitMissing(const Plan& plan, const RunOptions& options, const SlurmOptions& slurm,
                                    const std::vector<std::string>& workOptions);

/// What a task of a job array does: names of tasks of the plan and numbers of replicates. `text` is FILE:N, FILE a
/// tasks.json.
std::set<std::pair<std::string, int>> shareOfTask(const std::string& text);

}  // namespace ulam
