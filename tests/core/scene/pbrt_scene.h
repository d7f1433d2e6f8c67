#pragma once
// Scenes of pbrt-v4 written down in tests.

#include "core/scene/pbrt/pbrt.h"
#include "tests/support/error_of.h"
#include "tests/core/scene/load_text.h"

namespace ulam {

struct PbrtScene {
    SceneFolder folder{"pbrt_scene"};

    /// A whole file, or what stands in its world.
    JsonDocument readFile(const std::string& text, bool lenient = false) const {
        folder.write("scene.pbrt", text);
        return readPbrt(folder.path / "scene.pbrt", lenient);
    }
    JsonDocument read(const std::string& world, bool lenient = false) const {
        return readFile("Camera \"perspective\"\nWorldBegin\n" + world + "\n", lenient);
    }
    Complaint complaint(const std::string& world, bool lenient = false) const {
        return errorOf([&] { read(world, lenient); });
    }
    Scene load(const std::string& text) const {
        const JsonDocument document = readFile(text);
        return SceneDescription::fromNode(document.root(), folder.path).build();
    }
    Scene loadWorld(const std::string& world) const {
        return load("Camera \"perspective\"\nWorldBegin\n" + world + "\n");
    }
};

inline void near(const Json& values, const std::vector<double>& expected, double tolerance = 1e-9) {
    INFO(values.dump());
    REQUIRE(values.size() == expected.size());
    for (size_t i = 0; i < expected.size(); ++i)
        CHECK(values[i].get<double>() == Approx(expected[i]).margin(tolerance).epsilon(tolerance));
}

}  // namespace ulam
