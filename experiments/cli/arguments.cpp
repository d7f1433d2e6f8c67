#include "experiments/cli/arguments.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <system_error>
#include <thread>

#include "core/base/error.h"
#include "core/base/memory.h"
#include "core/config/suggest.h"
#include "core/render/sampler.h"
#include "core/scene/loading/scene_file.h"
#include "experiments/engine/lease.h"
#include "experiments/engine/provenance.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

void openPlugin(const std::string& file) {
    std::error_code error;
    if (!fs::exists(file, error))
        fail(ExitCode::InputMissing, "cannot open the plug-in {}: {}", inQuotes(file),
             error ? error.message() : "no such file");
    // Without a slash dlopen would search the system's folders only.
    const std::string path = fs::absolute(file).string();
    if (!::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL))
        fail(ExitCode::InvalidConfig, "cannot open the plug-in {}: {}", file, ::dlerror());
    addToCode(path);
}

bool looksLikeFile(const std::string& argument) { return argument.find('/') != argument.npos || fs::path(argument).extension() == ".json"; }

/// A file, inline JSON, or a name that becomes {"type": name}; `noName` fails for a word that is neither.
template <class Interface>
ArgumentDocument documentArgument(const std::string& argument) {
    if (argument.starts_with("{")) return {JsonDocument::fromText(argument, "command line"), fs::current_path()};
    const fs::path path = argument;
    if (looksLikeFile(argument)) return {JsonDocument::fromFile(path), path.parent_path(), path};
    const auto& registry = Registry<Interface>::instance();
    if (!registry.contains(argument))
        unknownName(Interface::kind(), argument, registry.names(), "the command line (a file's name ends in .json)");
    return {JsonDocument::fromText(Json({{"type", argument}}).dump(), argument), fs::current_path()};
}

}  // namespace

ArgumentDocument sceneArgument(const std::string& argument, const SceneFileOptions& options) {
    const fs::path path = argument;
    if (!argument.starts_with("{") && (looksLikeFile(argument) || path.extension() == ".xml" || path.extension() == ".pbrt"))
        return {readSceneDocument(path, options), path.parent_path(), path};
    if (!options.definitions.empty() || options.lenient) fail(ExitCode::Usage, "-D and --lenient are for scenes in files of other renderers");
    return documentArgument<Generator>(argument);
}

std::shared_ptr<SceneFileOptions> addSceneFileOptions(CLI::App& command) {
    auto options = std::make_shared<SceneFileOptions>();
    const auto parse = [options](const std::vector<std::string>& assignments) {
        for (const std::string& assignment : assignments) {
            const auto [name, value] = splitAssignment(assignment);
            options->definitions[name] = value;
        }
    };
    command.add_option_function<std::vector<std::string>>("-D", parse, "what $NAME stands for in a scene in Mitsuba's XML (repeatable)")
        ->type_name("NAME=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    command.add_flag("--lenient", options->lenient, "replace unknown plugins in Mitsuba's XML or a .pbrt file: magenta BSDFs and textures, others left out; results say so");
    return options;
}

void addResourceOption(CLI::App& command) {
    command
        .add_option_function<std::vector<std::string>>(
            "--resource-path",
            [](const std::vector<std::string>& folders) {
                for (const std::string& folder : folders) allowFilesFrom(folder);
            },
            "folder in which files that a scene names may also lie (repeatable)")
        ->type_name("DIR")
        ->take_all()
        ->allow_extra_args(false);
}

ArgumentDocument samplerArgument(const std::string& argument) {
    return documentArgument<Sampler>(argument);
}

void addPluginOption(CLI::App& command) {
    command
        .add_option_function<std::vector<std::string>>(
            "--plugin",
            [](const std::vector<std::string>& files) {
                for (const std::string& file : files) openPlugin(file);
            },
            "shared library with further mutations or samplers (repeatable)")
        ->type_name("FILE")
        ->take_all()
        ->allow_extra_args(false);
}

std::shared_ptr<int> addThreadsOption(CLI::App& command) {
    auto threads = std::make_shared<int>(std::max(1u, std::thread::hardware_concurrency()));
    command.add_option("--threads", *threads, "threads to render with")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    return threads;
}

std::shared_ptr<double> addLeaseOption(CLI::App& command) {
    auto seconds = std::make_shared<double>(kLeaseSeconds);
    command.add_option("--lease", *seconds, "seconds after which others take over what this process has stopped to work at")
        ->check(positiveNumber())
        ->capture_default_str();
    return seconds;
}

void addMemoryOption(CLI::App& command) {
    command
        .add_option_function<std::uint64_t>("--max-memory", limitMemory, "memory that may be taken, as 500M or 4G: what needs more is refused before")
        ->transform(CLI::AsSizeValue(false))
        ->type_name("SIZE");
}

std::shared_ptr<std::string> addViewerOption(CLI::App& command) {
    auto address = std::make_shared<std::string>();
    command.add_option("--tev", *address, "show images while they are made in the viewer tev, which listens there")->type_name("HOST:PORT");
    return address;
}

std::shared_ptr<std::uint64_t> addSeedOption(CLI::App& command) {
    auto seed = std::make_shared<std::uint64_t>(1);
    // CLI11's own conversion wraps what is out of range.
    const auto parse = [seed](const std::string& text) {
        const char* end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, *seed);
        if (error != std::errc() || stop != end)
            throw CLI::ValidationError(
                "--seed", fmt::format("expected a whole number from 0 to 2^64 - 1, found {}", inQuotes(text)));
    };
    command.add_option_function<std::string>("--seed", parse, "master seed")->type_name("UINT")->default_str("1");
    return seed;
}

CLI::Validator positiveNumber() {
    const auto check = [](const std::string& text) {
        double x = 0;
        const bool fits = CLI::detail::lexical_cast(text, x) && std::isfinite(x) && x > 0;
        return fits ? std::string() : fmt::format("expected a number above 0, found {}", inQuotes(text));
    };
    return CLI::Validator(check, "NUMBER > 0");
}

void checkWritable(const std::string& file) {
    const fs::path path = file;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
    int error = ::access(folder.c_str(), W_OK) == 0 ? 0 : errno;
    std::error_code failed;
    if (!error && !fs::is_directory(folder, failed)) error = ENOTDIR;
    if (!error && fs::is_directory(path, failed)) error = EISDIR;
    // A name that is too long, a ring of links.
    if (!error && !fs::exists(path, failed) && failed) error = failed.value();
    if (error) fail(ExitCode::CannotWrite, "cannot write {}: {}", file, std::generic_category().message(error));
}

bool isSameFile(const std::string& a, const std::string& b) {
    std::error_code failed;
    // What is not there yet stays relative unless it is made absolute first.
    const auto real = [&](const std::string& file) { return fs::weakly_canonical(fs::absolute(file, failed), failed); };
    const fs::path first = real(a);
    return !first.empty() && first == real(b);
}

}  // namespace ulam
