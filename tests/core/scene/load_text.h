#pragma once
// Scenes written down in tests.

#include <filesystem>
#include <fstream>
#include <string>

#include "core/base/error.h"
#include "core/scene/load.h"
#include "tests/support/catch.h"

namespace ulam {

/// A folder of its own, removed at the end.
struct SceneFolder {
    std::filesystem::path path;

    explicit SceneFolder(const std::string& name) : path(std::filesystem::temp_directory_path() / ("ulam_" + name)) {
        std::filesystem::remove_all(path);
        std::filesystem::create_directories(path);
    }
    ~SceneFolder() { std::filesystem::remove_all(path); }

    void write(const std::string& file, const std::string& bytes) const {
        std::ofstream(path / file, std::ios::binary) << bytes;
    }
};

inline SceneDescription describeText(const std::string& text, const std::filesystem::path& folder = "/nonexistent") {
    return SceneDescription::fromNode(JsonDocument::fromText(text, "scene.json").root(), folder);
}

inline Scene loadText(const std::string& text, const std::filesystem::path& folder = "/nonexistent") {
    return describeText(text, folder).build();
}

/// A scene with a sensor, a light and these entries.
inline std::string sceneWith(const std::string& entries) {
    return R"({"type": "scene", "sensor": {"type": "perspective"}, "light": {"type": "point"})" +
           (entries.empty() ? "" : ", " + entries) + "}";
}

/// The message of the error that loading this scene must give; its exit code must be the expected one.
inline std::string errorOf(const std::string& text, ExitCode code = ExitCode::InvalidConfig,
                           const std::filesystem::path& folder = "/nonexistent") {
    try {
        loadText(text, folder);
    } catch (const Error& error) {
        CHECK(error.code() == code);
        return error.what();
    }
    FAIL("no error for " << text);
    return "";
}

inline bool mentions(const std::string& message, const std::string& part) {
    return message.find(part) != std::string::npos;
}

}  // namespace ulam
