#include "experiments/engine/provenance.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include "build_info.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/scene/ray_tracer.h"

namespace ulam {
namespace {

/// What follows the separator in the first line of a file that begins with the key, without blanks and quotes around it;
/// empty where there is none.
std::string lineValue(const char* file, std::string_view key, char separator) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        const std::size_t end = line.find(separator);
        if (!line.starts_with(key) || end == line.npos) continue;
        constexpr const char* kAround = " \t\"'";
        const std::size_t begin = line.find_first_not_of(kAround, end + 1);
        return begin == line.npos ? "" : line.substr(begin, line.find_last_not_of(kAround) + 1 - begin);
    }
    return "";
}

const char* const kExecutable = "/proc/self/exe";

std::string& mutableCodeHash() {
    static std::string hash = sha256OfFile(kExecutable);
    return hash;
}

std::string kernelValue(const char* file, std::string_view key) {
    return lineValue(file, key, ':');
}

}  // namespace

std::string programVersion() {
    return build::kVersion;
}

const std::string& codeHash() {
    return mutableCodeHash();
}

void addToCode(const std::string& plugin) {
    mutableCodeHash() = sha256(codeHash() + sha256OfFile(plugin));
}

std::vector<std::string> processArguments() {
    std::vector<std::string> arguments;
    std::ifstream stream("/proc/self/cmdline");
    for (std::string argument; std::getline(stream, argument, '\0');) arguments.push_back(argument);
    return arguments;
}

const Json& simd() {
#if defined(__AVX512F__)
    constexpr const char* compiled = "avx512";
#elif defined(__AVX2__)
    constexpr const char* compiled = "avx2";
#elif defined(__AVX__)
    constexpr const char* compiled = "avx";
#else
    constexpr const char* compiled = "sse";
#endif
    static const Json used = {{"compiled", compiled}, {"ray_tracer", rayTracerInstructions()}};
    return used;
}

const std::string& processorName() {
    static const std::string name = kernelValue("/proc/cpuinfo", "model name");
    return name;
}

std::string utcNow() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    char text[32];
    return std::string(text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts));
}

Json provenance(const std::vector<std::string>& arguments) {
    utsname system{};
    ::uname(&system);
    return {
        {"schema_version", 1},
        {"started", utcNow()},
        {"arguments", arguments},
        {"folder", std::filesystem::current_path().string()},
        {"program",
         {{"name", "ulam"},
          {"version", build::kVersion},
          {"commit", build::kCommit},
          {"build", build::kType},
          {"compiler", build::kCompiler},
          {"flags", build::kFlags},
          {"simd", simd()},
          {"cmake", build::kCmake},
          {"executable_sha256", sha256OfFile(kExecutable)},
          {"code_sha256", codeHash()}}},
        {"libraries",
         {{"embree", build::kEmbree},
          {"openimageio", build::kOpenImageIo},
          {"imath", build::kImath},
          {"tbb", build::kTbb},
          {"boost", build::kBoost},
          {"fmt", build::kFmt},
          {"nlohmann_json", build::kJson},
          {"cli11", build::kCli11}}},
        {"machine",
         {{"host", hostName()},
          {"system", system.sysname},
          {"kernel", system.release},
          {"architecture", system.machine},
          {"distribution", lineValue("/etc/os-release", "PRETTY_NAME", '=')},
          {"cpu", processorName()},
          {"cpu_flags", kernelValue("/proc/cpuinfo", "flags")},
          {"cores", std::thread::hardware_concurrency()},
          {"memory", kernelValue("/proc/meminfo", "MemTotal")}}},
    };
}

}  // namespace ulam
