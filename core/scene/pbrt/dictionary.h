#pragma once
// The scene dictionary in the making, and what readers of all kinds of plugins share.

#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "core/config/json.h"
#include "core/scene/pbrt/parameters.h"

namespace ulam::pbrt {

class Dictionary {
public:
    Dictionary(std::filesystem::path sceneFolder, bool isLenient)
        : folder(std::move(sceneFolder)), lenient(isLenient) {}

    /// A free name for an entry: the wanted one, or one with a number.
    std::string name(const std::string& wanted);
    /// Adds an entry under a name from `name`.
    void add(const std::string& entry, Json plugin, const Place& place);
    /// Messages about a value say this place: "/entry/parameter".
    void note(const std::string& entry, const std::string& key, const Place& place);
    /// What stands for something else; results of the scene's images say so.
    void substitute(std::string text) { substitutions_.push_back(std::move(text)); }
    /// A plugin of a type that is not known, or a feature that is not supported: fails, or where the reader is lenient
    /// says what takes its place.
    void unknown(std::string_view kind, const std::string& type, const std::vector<std::string>& known,
                 const Place& place, std::string_view instead);
    void unsupported(const std::string& what, const Place& place, std::string_view hint, std::string_view instead);

    JsonDocument document(std::string file, const Place& whole);

    const std::filesystem::path folder;  ///< of the scene
    const bool lenient;
    double subdivided = 0;  ///< triangles of all subdivided meshes

private:
    std::set<std::string> names_{"type", "id", "integrator", "sampler", "accelerator", "sensor"};
    std::map<std::string, int> counters_;  ///< by wanted name
    Json scene_ = {{"type", "scene"}};
    std::vector<std::pair<std::string, std::string>> places_;
    std::vector<std::string> substitutions_;
};

/// A number where it has no colour.
Json colourJson(const Spectrum& colour);

/// 16 numbers, row-major.
Json matrixJson(const Matrix4& m);

}  // namespace ulam::pbrt
