// The program `ulam`: results on stdout, progress and messages on stderr, exit codes as in core/base/error.h.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "core/base/error.h"
#include "core/config/suggest.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/provenance.h"

namespace {

using ulam::ExitCode;

bool isOptionGroup(const CLI::App* command) {
    return command->get_name().empty();
}

/// CLI11 would only say that the word was not expected.
void checkCommand(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({}))
        if (!isOptionGroup(command)) names.push_back(command->get_name());
    if (names.empty() || word.starts_with("-") || std::find(names.begin(), names.end(), word) != names.end()) return;
    const std::string hint = ulam::didYouMean(word, names);
    ulam::fail(ExitCode::Usage, "unknown command {}{}{}; known: {}", ulam::inQuotes(word), hint.empty() ? "" : ", ",
               hint, ulam::listInQuotes(names));
}

std::vector<std::string> optionNames(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    for (const CLI::App* group : command.get_subcommands(isOptionGroup))
        for (const std::string& name : optionNames(*group)) names.push_back(name);
    return names;
}

/// Unknown options and commands that are left over; CLI11 complains of what is missing first, which may be the same.
void checkLeftOver(const CLI::App& command, const std::string& fullName) {
    for (const std::string& word : command.remaining()) {
        if (word == "--") break;  // words after it are no options
        checkCommand(command, word);
        if (!word.starts_with("-")) continue;
        const std::string option = word.substr(0, word.find('='));
        // Of one letter every other one is near.
        const std::string hint = option.size() > 2 ? ulam::didYouMean(option, optionNames(command)) : "";
        ulam::fail(ExitCode::Usage, "unknown option {} of {}; {}", ulam::inQuotes(option), fullName,
                   hint.empty() ? fmt::format("see {} --help", fullName) : hint);
    }
    for (const CLI::App* given : command.get_subcommands()) checkLeftOver(*given, fullName + " " + given->get_name());
}

[[noreturn]] void failToPrint() {
    ulam::fail(ExitCode::CannotWrite, "cannot write to the standard output");
}

ExitCode runProgram(int argc, char* argv[]) {
    CLI::App app("Metropolis light transport: render, compare, run experiments.", "ulam");
    app.set_version_flag("--version", ulam::programVersion());
    app.require_subcommand(1);
    ulam::addRunCommand(app);
    ulam::addWorkCommand(app);
    ulam::addStatusCommand(app);
    ulam::addRenderCommand(app);
    ulam::addCompareCommand(app);
    ulam::addSceneCommand(app);
    ulam::addListCommand(app);
    ulam::addSchemaCommand(app);
    ulam::addReportCommand(app);
    ulam::addReferenceCommand(app);
    ulam::addWatchCommand(app);
    ulam::addNewCommand(app);
    ulam::addBenchCommand(app);
    ulam::addVerifyCommand(app);
    ulam::addReplayPathCommand(app);
    if (argc > 1) checkCommand(app, argv[1]);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) checkLeftOver(app, app.get_name());
        if (app.exit(error) != 0) return ExitCode::Usage;
    } catch (const std::system_error&) {
        // Of a result beyond the stream's buffer it is fmt::print that fails.
        if (std::ferror(stdout)) failToPrint();
        throw;
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) failToPrint();
    return ExitCode::Done;
}

/// Not with fmt::print, which throws where stderr cannot be written.
int report(ExitCode code, const std::string& message) {
    std::fputs(("ulam: " + message + "\n").c_str(), stderr);
    return static_cast<int>(code);
}

int reportOutOfMemory(const std::exception& error) {
    return report(
        ExitCode::InvalidConfig,
        fmt::format("out of memory: image, scene or parameters ask for more than there is ({})", error.what()));
}

}  // namespace

int main(int argc, char* argv[]) {
    try {
        return static_cast<int>(runProgram(argc, argv));
    } catch (const ulam::Error& error) {
        return report(error.code(), error.what());
    } catch (const std::bad_alloc& error) {
        return reportOutOfMemory(error);
    } catch (const std::length_error& error) {
        return reportOutOfMemory(error);
    } catch (const std::filesystem::filesystem_error& error) {
        const bool missing = error.code() == std::errc::no_such_file_or_directory;
        return report(missing ? ExitCode::InputMissing : ExitCode::CannotWrite, error.what());
    } catch (const std::exception& error) {
        if (std::ferror(stderr)) return static_cast<int>(ExitCode::CannotWrite);
        return report(ExitCode::SomeCellsFailed, fmt::format("internal error: {}", error.what()));
    }
}
