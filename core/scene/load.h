#pragma once
// From a scene dictionary (Mitsuba 3's vocabulary as JSON) to a Scene. One loader for every source of scenes.

#include "core/config/json.h"
#include "core/scene/generator.h"
#include "core/scene/loading/file_options.h"
#include "core/scene/scene.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace ulam {

/// The scene dictionary in a file: Mitsuba's XML where the name ends in .xml, a scene of pbrt-v4 where it ends in .pbrt,
/// else JSON.
JsonDocument readSceneDocument(const std::filesystem::path& file, const SceneFileOptions& options = {});

/// A scene dictionary with the place it came from. A generator is expanded on construction.
class SceneDescription {
public:
    /// From a file, see readSceneDocument.
    static SceneDescription fromFile(const std::filesystem::path& file);
    /// From a dictionary inside another document; a string is a path relative to `folder`.
    static SceneDescription fromNode(const JsonNode& node, const std::filesystem::path& folder);

    /// Ordinary dictionary, generators expanded.
    const Json& dictionary() const;
    /// Where relative paths in the dictionary start from.
    const std::filesystem::path& folder() const;
    /// The generator it came from, or null. It outlives the description.
    const std::shared_ptr<const Generator>& generator() const;

    /// Builds the scene. Keys of `film` (width, height, crop_*, rfilter), if given, override those in the sensor's film.
    /// Every value is validated; errors name file and place.
    Scene build(const Json& film = {}) const;
    /// The film size that build() gives.
    FilmSize filmSize(const Json& film = {}) const;

private:
    struct Content;
    std::shared_ptr<const Content> content_;
};

}  // namespace ulam
