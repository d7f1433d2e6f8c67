#pragma once
// pbrt's graphics state: what holds for the shapes and lights that follow, and the directives that change it.

#include "core/scene/pbrt/shapes.h"

namespace ulam::pbrt {

struct GraphicsState {
    Matrix4 toWorld;
    bool reversed = false;
    MaterialUse material;
    std::optional<std::pair<std::string, Parameters>> areaLight;  ///< type and parameters
    std::map<std::string, std::vector<Parameter>> defaults;       ///< of Attribute directives, by what they are for
};

class GraphicsStates {
public:
    GraphicsState now;

    /// Reads a directive if it is one that changes the state alone: transformations and the stack.
    bool read(std::string_view directive, Tokens& tokens, const Place& place);
    static const std::vector<std::string>& directives();

    /// "Attribute", "Transform", "Object" or "Import".
    void push(const std::string& kind, const Place& place);
    void pop(const std::string& kind, const Place& place);
    /// Fails where one is open.
    void needsClosed() const;

    void nameCoordinates(const std::string& name) { coordinates_[name] = now.toWorld; }
    /// The camera sees the world through the inverse of its state.
    void nameCamera() { coordinates_["camera"] = now.toWorld.inverse(); }

private:
    struct Saved {
        std::string kind;
        GraphicsState state;
        Place place;
    };

    void transform(const Matrix4& m, const Place& place);

    std::vector<Saved> stack_;
    std::map<std::string, Matrix4> coordinates_;
};

}  // namespace ulam::pbrt
