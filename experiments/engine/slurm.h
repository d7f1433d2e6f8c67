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
    double taskMinutes = 15;  ///< usual length of a task, see shareOut
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

/// Shares of pieces of work that are expected to take `seconds` each, as indices into them: what the tasks of an array
/// do. A share takes from kShortestShare to kLongestShare times `usual` seconds, more where it is a single piece that
/// does, less where that is all there is, or all that is left beside pieces so long that it fits with none of them.
std::vector<std::vector<std::size_t>> shareOut(const std::vector<double>& seconds, double usual);
/// Of the usual 15 minutes: 5 and 30 minutes.
inline constexpr double kShortestShare = 1.0 / 3, kLongestShare = 2;

/// Writes the header of the run, and submits what is neither finished, nor held by a process, nor waiting in the queue;
/// what failed counts as missing. Where all replicates so far are there (with keepGoing: or have failed), the looks of
/// "until" come first, as in runPlan, and what they add to the plan is submitted. `workOptions`: further arguments of
/// `ulam work`. Fails with InputMissing where Slurm's commands cannot be run, and with Usage where sbatch refuses.
std::vector<JobArray> submitMissing(Plan& plan, const RunOptions& options, const SlurmOptions& slurm,
                                    const std::vector<std::string>& workOptions, Progress& progress);

/// What a task of a job array does: names of tasks of the plan and numbers of replicates. `text` is FILE:N, FILE a
/// tasks.json.
std::set<std::pair<std::string, int>> shareOfTask(const std::string& text);

}  // namespace ulam
