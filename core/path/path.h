#pragma once
// A light path x = x_0 … x_k as a value: x_0 on the light, x_k on the lens.

#include "core/path/primary_vector.h"
#include "core/scene/scene.h"

namespace ulam {

/// Bidirectional technique: s vertices made from the light, t from the camera. s = 0: the camera walk hits the light;
/// s = 1: next-event estimation; t = 1: the light walk is joined to the lens and splatted.
struct Technique {
    int s = 0, t = 0;
    bool operator==(const Technique&) const = default;

    template <class Archive>
    void archive(Archive& a) {
        a(s, t);
    }
};

class Path {
public:
    Path() : size_(0) {}
    Path(const Path& other) { *this = other; }
    Path& operator=(const Path& other) {
        size_ = other.size_;
        std::copy_n(other.vertices_.begin(), size_, vertices_.begin());
        return *this;
    }

    int size() const { return size_; }
    /// Edges: k.
    int length() const { return size_ - 1; }
    void resize(int vertices) { size_ = vertices; }
    Vertex& operator[](int i) { return vertices_[i]; }
    const Vertex& operator[](int i) const { return vertices_[i]; }
    const Vertex& light() const { return vertices_[0]; }
    const Vertex& camera() const { return vertices_[size_ - 1]; }
    void append(const Vertex& v) { vertices_[size_++] = v; }

    template <class Archive>
    void archive(Archive& a) {
        a(size_);
        for (int i = 0; i < size_; ++i) a(vertices_[size_t(i)]);
    }

private:
    int size_;
    std::array<Vertex, kMaxVertices> vertices_;
};

/// May x_i and x_{i+1} be joined by a connection? The one place where this is decided.
inline bool connectable(const Vertex& a, const Vertex& b) { return !isDelta(a.lobe) && !isDelta(b.lobe); }

/// Can a walk from the other end arrive at this end of a path? A delta light has no extent, and lenses are not in the scene.
inline bool hittable(const Vertex& end) { return end.kind == Vertex::Kind::Surface || end.kind == Vertex::Kind::Infinite; }

/// Can a camera see this light itself? A delta light has no extent, so no pixel shows it.
inline bool showsItself(const Vertex& light) { return hittable(light); }

/// The last feature crossed before the camera, or kNone.
uint32_t featureOf(const Features& features, const Path& path);

}  // namespace ulam
