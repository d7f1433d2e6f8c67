#pragma once
// What a run of an experiment consists of: scenes, references, cells, comparisons, and the order of the work.

#include <map>
#include <memory>

#include "core/scene/load.h"
#include "experiments/engine/experiment.h"
#include "experiments/engine/scene_store.h"
#include "experiments/engine/sweep.h"
#include "experiments/statistics/design.h"

namespace ulam {

/// A scene as some cells see it, with the experiment's film. It was built once, to be checked.
struct PlannedScene {
    std::string name;
    Json description;  ///< as written, a generator's defaults filled in
    Json film;
    Json source;  ///< how to get it again: see sceneSource
    std::shared_ptr<const Generator> generator;  ///< null for an ordinary scene
    FilmSize filmSize;
    ReconstructionFilter filter;
    Features features;
    std::string hash;
    std::vector<std::string> warnings, substitutions;  ///< as Scene's
    double setupSeconds = 0;
    BuildScene build;

    /// Built again where it is not in memory (see sceneFor).
    std::shared_ptr<const Scene> scene() const { return sceneFor(hash, build); }
};

/// One algorithm on one scene with one budget: what is run in independent replicates.
struct Task {
    std::string name;  ///< of its folder
    std::string stream;  ///< what its random numbers depend on, beside seed and replicate: its name, or what cells share
    std::shared_ptr<const PlannedScene> scene;
    std::string sampler;  ///< its name in the experiment
    Json parameters;
    Budget budget;  ///< of one replicate
    int maxDepth = 8;
    int replicates = 1;  ///< of an experiment with "until" those so far
    int snapshots = 0;
    std::uint64_t seed = 1;

    RandomKey key(int replicate) const;
    /// Of everything that determines the numbers of a replicate, the program's version included.
    std::string hash() const;
};

struct PlannedReference {
    std::string key;  ///< folder below references/
    ReferenceSpec spec;
    std::shared_ptr<const PlannedScene> scene;
    Task task;  ///< where a sampler makes it: one replicate is a part of the whole; of all who ask for it the most
};

/// A point of scenes × samplers × sweep.
struct Cell {
    Task task;
    Json sweep = Json::object();  ///< the values that make this cell, by path
    std::size_t reference = 0;    ///< index into Plan::references
};

struct PlannedComparison {
    std::size_t cell, baseline;  ///< indices into Plan::cells
};

struct Plan {
    std::string name;
    Json experiment;     ///< the document, overrides applied
    std::string source;  ///< its file
    std::vector<std::string> metrics;
    std::uint64_t seed = 1;
    std::optional<UntilParameters> until;
    statistics::Design design;  ///< of the comparisons
    std::vector<PlannedReference> references;
    std::vector<Cell> cells;
    std::vector<PlannedComparison> comparisons;

    struct Replicate {
        std::size_t cell;
        int number;
    };
    /// Block after block of one replicate of every cell, each in an order of its own, so that drift of the machine
    /// hits all cells alike. `done` has the number of replicates of each cell that are left out, its first ones.
    std::vector<Replicate> order(const std::vector<int>& done = {}) const;
    /// How many each cell has so far.
    std::vector<int> replicatesOfCells() const;
    /// The smallest adjusted p of each comparison when it has as many replicates as it can get.
    std::vector<double> smallestAdjustedP() const;
    /// resolved.json: every default, every seed, scene hashes.
    Json resolved() const;
};

/// Parses every point of the sweep, builds the scenes and drops cells that a sweep leaves as they are.
Plan makePlan(const JsonDocument& document, const std::filesystem::path& file);

}  // namespace ulam
