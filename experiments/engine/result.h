#pragma once
// One run on disk: its image, its snapshots and result.json (contract: "What a run leaves").

#include <filesystem>
#include <string>

#include "core/config/json.h"
#include "core/image/image_io.h"
#include "core/render/driver.h"

namespace ulam {

/// What a run is, beside what it found.
struct RunIdentity {
    std::string scene;
    std::string sceneHash;
    std::string sampler;
    Json parameters;  ///< of the sampler: "type" and every parameter
    std::uint64_t seed = 0;
    int replicate = 0;
    RandomKey key;
    int threads = 1;
    double setupSeconds = 0;  ///< loading the scene, building the acceleration structure
    Json source;              ///< how to get the scene again: see sceneSource
};

/// {"scene": a dictionary or the absolute path of a file, "folder": where relative paths in it start from, "film": options
/// above its own}; for a file of another renderer also "set", "definitions" and "lenient", as on the command line.
Json sceneSource(const Json& scene, const std::filesystem::path& folder, const Json& film);

/// {"type": name, every parameter…} of a sampler's dictionary, checked.
Json resolveSampler(const JsonNode& sampler);

/// The fields of result.json. Snapshots name the files that writeRun writes.
Json resultJson(const RunIdentity& run, const RenderResult& result, const Features& features);

/// Seed, sampler, scene hash and program version as attributes of an EXR.
ImageAttributes imageAttributes(const RunIdentity& run);

/// Every pixel is 0.
bool isBlack(const Image& image);

/// What a user should hear about a run, in words: what was refused, by cause, and how to see the first.
std::vector<std::string> warningsOf(const RunIdentity& run, const RenderResult& result);

/// Fails with InvalidConfig where no path carried light.
void refuseBlackImage(const RunIdentity& run, const RenderResult& result);

/// SHA-256 of width, height and the float values.
std::string imageHash(const Image& image);

/// An image whose hash was recorded when it was written. Errors as readImage, and InvalidConfig where the hash differs.
Image readRecordedImage(const std::filesystem::path& file, const JsonNode& hash);

/// Writes image.exr, snapshots/, extra/ and chains.npy into a folder that is made, and result.json last: a run with a result.json
/// is complete.
void writeRun(const std::filesystem::path& folder, const RunIdentity& run, const RenderResult& result,
              const Json& resultFields);

/// create_directories with CannotWrite and the reason.
void makeFolder(const std::filesystem::path& folder);

}  // namespace ulam
