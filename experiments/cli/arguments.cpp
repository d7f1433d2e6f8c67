#include "experiments/cli/arguments.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <system_error>
#include <thread>

#include "core/base/error.h"
#include "core/config/suggest.h"
#include "core/render/sampler.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

void openPlugin(const std::string& file) {
    // Without a slash dlopen would search the system's folders only.
    const std::string path = fs::absolute(file).string();
    if (!fs::exists(path)) fail(ExitCode::InputMissing, "cannot open the plug-in {}: no such file", file);
    if (!::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL))
        fail(ExitCode::InvalidConfig, "cannot open the plug-in {}: {}", file, ::dlerror());
}

/// A file, inline JSON, or a name that becomes {"type": name}; `noName` fails for a word that is neither.
template <class Interface>
ArgumentDocument documentArgument(const std::string& argument, const std::vector<std::string>& extensions) {
    if (argument.starts_with("{")) return {JsonDocument::fromText(argument, "command line"), fs::current_path()};
    const fs::path path = argument;
    const bool looksLikeFile = argument.find('/') != argument.npos ||
                               std::find(extensions.begin(), extensions.end(), path.extension()) != extensions.end();
    if (looksLikeFile) return {JsonDocument::fromFile(path), path.parent_path()};
    std::vector<std::string> names;
    for (const auto* entry : Registry<Interface>::instance().entries()) names.push_back(entry->name);
    if (std::find(names.begin(), names.end(), argument) == names.end())
        unknownName(Interface::kind(), argument, names, "the command line (a file's name ends in .json)");
    return {JsonDocument::fromText(Json({{"type", argument}}).dump(), argument), fs::current_path()};
}

}  // namespace

ArgumentDocument sceneArgument(const std::string& argument) {
    return documentArgument<Generator>(argument, {".json"});
}

ArgumentDocument samplerArgument(const std::string& argument) {
    return documentArgument<Sampler>(argument, {".json"});
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
    if (!error && !fs::is_directory(folder)) error = ENOTDIR;
    if (!error && fs::is_directory(path)) error = EISDIR;
    if (error) fail(ExitCode::CannotWrite, "cannot write {}: {}", file, std::generic_category().message(error));
}

}  // namespace ulam
