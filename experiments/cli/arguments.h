#pragma once
// Arguments that several commands share.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/load.h"

namespace ulam {

/// A document named on the command line and the folder that relative paths inside it start from.
struct ArgumentDocument {
    JsonDocument document;
    std::filesystem::path folder;
    std::optional<std::filesystem::path> file = {};  ///< none: JSON or a name on the command line
};

/// SCENE: a JSON, XML or pbrt file, a generator's name, or JSON itself.
ArgumentDocument sceneArgument(const std::string& argument, const SceneFileOptions& options = {});
/// `-D NAME=VALUE`, repeatable, and `--lenient`.
std::shared_ptr<SceneFileOptions> addSceneFileOptions(CLI::App& command);
/// `--resource-path DIR`, repeatable: see allowFilesFrom, which is called while the command line is parsed.
void addResourceOption(CLI::App& command);
/// A sampler's name, a JSON file with its parameters, or JSON itself.
ArgumentDocument samplerArgument(const std::string& argument);

/// `--plugin FILE`, repeatable: shared libraries that register mutations, samplers or generators. The file is opened
/// while the command line is parsed, before the command runs; one that cannot be opened fails with the reason.
void addPluginOption(CLI::App& command);

/// `--threads N`, by default the number of cores.
std::shared_ptr<int> addThreadsOption(CLI::App& command);

/// `--lease SECONDS`: see Lease.
std::shared_ptr<double> addLeaseOption(CLI::App& command);

/// `--max-memory SIZE`: see limitMemory, which is called while the command line is parsed.
void addMemoryOption(CLI::App& command);

/// `--tev HOST:PORT`: empty where it is not given.
std::shared_ptr<std::string> addViewerOption(CLI::App& command);

/// `--seed N`, by default 1.
std::shared_ptr<std::uint64_t> addSeedOption(CLI::App& command);

/// Refuses what is not a finite number above 0.
CLI::Validator positiveNumber();

/// Fails with CannotWrite unless a file of this name can be made: better before hours of work than after.
void checkWritable(const std::string& file);

/// Whether two names stand for one file, which need not be there yet.
bool isSameFile(const std::string& a, const std::string& b);

}  // namespace ulam
