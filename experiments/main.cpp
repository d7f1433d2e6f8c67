// The program `ulam`: results on stdout, progress and messages on stderr, exit codes as in core/base/error.h.

#include <algorithm>
#include <cstdio>

#include "core/base/error.h"
#include "core/config/suggest.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/provenance.h"

namespace {

using ulam::ExitCode;

/// CLI11 would only say that the word was not expected.
void checkCommand(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (word.starts_with("-") || std::find(names.begin(), names.end(), word) != names.end()) return;
    const std::string hint = ulam::didYouMean(word, names);
    ulam::fail(ExitCode::Usage, "unknown command {}{}{}; known: {}", ulam::inQuotes(word), hint.empty() ? "" : ", ",
               hint, ulam::listInQuotes(names));
}

ExitCode runProgram(int argc, char* argv[]) {
    CLI::App app("Metropolis light transport: render, compare, run experiments.", "ulam");
    app.set_version_flag("--version", ulam::programVersion());
    app.require_subcommand(1);
    ulam::addRunCommand(app);
    ulam::addRenderCommand(app);
    ulam::addCompareCommand(app);
    ulam::addSceneCommand(app);
    ulam::addListCommand(app);
    ulam::addSchemaCommand(app);
    ulam::addReportCommand(app);
    ulam::addNewCommand(app);
    ulam::addBenchCommand(app);
    ulam::addVerifyCommand(app);
    if (argc > 1) checkCommand(app, argv[1]);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? ExitCode::Done : ExitCode::Usage;
    }
    if (std::fflush(stdout) != 0) ulam::fail(ExitCode::CannotWrite, "cannot write to the standard output");
    return ExitCode::Done;
}

}  // namespace

int main(int argc, char* argv[]) {
    try {
        return static_cast<int>(runProgram(argc, argv));
    } catch (const ulam::Error& error) {
        fmt::print(stderr, "ulam: {}\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        fmt::print(stderr, "ulam: internal error: {}\n", error.what());
        return static_cast<int>(ExitCode::SomeCellsFailed);
    }
}
