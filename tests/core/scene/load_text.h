#pragma once
// Scenes written down in tests.

#include <filesystem>
#include <fstream>
#include <string>

#include "core/scene/load.h"
#include "tests/support/catch.h"
#include "tests/support/error_of.h"

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

/// An entry of a scene that was converted.
inline Json entry(const JsonDocument& document, const char* name) {
    return document.json().at(name);
}

/// A file of one triangle.
inline const char* const kTrianglePly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// A scene with a sensor, a light and these entries.
inline std::string sceneWith(const std::string& entries) {
    return R"({"type": "scene", "sensor": {"type": "perspective"}, "light": {"type": "point"})" +
           (entries.empty() ? "" : ", " + entries) + "}";
}

/// The message of the error that loading this scene must give; its exit code must be the expected one.
inline std::string errorOf(const std::string& text, ExitCode code = ExitCode::InvalidConfig,
                           const std::filesystem::path& folder = "/nonexistent") {
    const Complaint complaint = errorOf([&] { loadText(text, folder); });
    INFO(text << ": " << complaint.message);
    CHECK(complaint.code == code);
    return complaint.message;
}

}  // namespace ulam
