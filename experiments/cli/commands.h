#pragma once
// The commands of the program. Each function adds one with its options; its action throws an Error where it ends with
// an exit code other than 0.

#include <CLI/CLI.hpp>

namespace ulam {

void addRunCommand(CLI::App& app);
void addWorkCommand(CLI::App& app);
void addStatusCommand(CLI::App& app);
void addRenderCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addSceneCommand(CLI::App& app);
void addListCommand(CLI::App& app);
void addSchemaCommand(CLI::App& app);
void addReportCommand(CLI::App& app);
void addReferenceCommand(CLI::App& app);
void addWatchCommand(CLI::App& app);
void addNewCommand(CLI::App& app);
void addBenchCommand(CLI::App& app);
void addVerifyCommand(CLI::App& app);
void addReplayPathCommand(CLI::App& app);

}  // namespace ulam
