#include "core/base/error.h"
#include "core/scene/mesh_io.h"
#include "core/scene/text_scanner.h"

namespace ulam {
namespace {

class ObjReader {
public:
    ObjReader(std::string_view name, bool flipTexCoords) : name_(name), flipTexCoords_(flipTexCoords) {}

    Mesh read(std::string_view text);

private:
    /// Position, texture coordinate and normal of a face's corner, counted from 0, or kNone.
    using Corner = std::array<uint32_t, 3>;

    template <class... Arguments>
    [[noreturn]] void error(fmt::format_string<Arguments...> format, Arguments&&... arguments) const {
        fail(ExitCode::InvalidConfig, "{}:{}: {}", name_, line_,
             fmt::format(format, std::forward<Arguments>(arguments)...));
    }

    float coordinate(std::string_view& line) const;
    uint32_t index(std::string_view word, size_t count, const char* what) const;
    uint32_t& place(const Corner& corner);
    void makeRoom();
    uint32_t vertex(std::string_view corner);
    void face(std::string_view line);

    std::string_view name_;
    bool flipTexCoords_;
    size_t line_ = 0;
    std::vector<Vec3f> positions_, normals_;
    std::vector<Vec2f> texcoords_;
    std::vector<Corner> vertices_;  ///< what the mesh's vertices were made of
    std::vector<uint32_t> table_ = std::vector<uint32_t>(64, kNone);  ///< their numbers, hashed: a power of 2, at most half full
    std::vector<uint32_t> corners_;
    Mesh mesh_;
};

float ObjReader::coordinate(std::string_view& line) const {
    const std::string_view word = nextWord(line);
    const auto value = toNumber<double>(word);
    if (!value) error("expected a number, found \"{}\"", word);
    return float(*value);
}

uint32_t ObjReader::index(std::string_view word, size_t count, const char* what) const {
    if (word.empty()) return kNone;
    const auto value = toNumber<int64_t>(word);
    if (!value || *value == 0 || *value > int64_t(count) || *value < -int64_t(count))
        error("\"{}\" is no {}: {} are there so far (counted from 1, or from the end with a minus)", word, what, count);
    return uint32_t(*value > 0 ? *value - 1 : int64_t(count) + *value);
}

/// Where the number of the vertex made of a corner stands, or may be put.
uint32_t& ObjReader::place(const Corner& corner) {
    // Neighbours in the file stay neighbours where faces name positions only.
    size_t i = corner[0] + size_t(corner[1]) * 0x9e3779b97f4a7c15ull + size_t(corner[2]) * 0xc2b2ae3d27d4eb4full;
    while (true) {
        uint32_t& vertex = table_[i & (table_.size() - 1)];
        if (vertex == kNone || vertices_[vertex] == corner) return vertex;
        ++i;
    }
}

void ObjReader::makeRoom() {
    if (2 * (vertices_.size() + 1) <= table_.size()) return;
    table_.assign(2 * table_.size(), kNone);
    for (uint32_t i = 0; i < vertices_.size(); ++i) place(vertices_[i]) = i;
}

uint32_t ObjReader::vertex(std::string_view corner) {
    std::array<std::string_view, 3> parts;
    std::string_view rest = corner;
    for (size_t i = 0; i < 3; ++i) {
        const size_t slash = rest.find('/');
        parts[i] = rest.substr(0, slash);
        rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
    }
    const Corner key{index(parts[0], positions_.size(), "vertex"),
                     index(parts[1], texcoords_.size(), "texture coordinate"),
                     index(parts[2], normals_.size(), "normal")};
    if (key[0] == kNone || !rest.empty()) error("\"{}\" is no corner of a face", corner);
    makeRoom();
    uint32_t& known = place(key);
    if (known != kNone) return known;
    const uint32_t vertex = known = uint32_t(vertices_.size());
    vertices_.push_back(key);
    mesh_.positions.push_back(positions_[key[0]]);
    // Vertices before the first that has a texture coordinate or a normal have none: zero.
    if (key[1] != kNone) mesh_.texcoords.resize(vertex, Vec2f(0.0f)), mesh_.texcoords.push_back(texcoords_[key[1]]);
    if (key[2] != kNone) mesh_.normals.resize(vertex, Vec3f(0.0f)), mesh_.normals.push_back(normals_[key[2]]);
    return vertex;
}

void ObjReader::face(std::string_view line) {
    corners_.clear();
    for (std::string_view word = nextWord(line); !word.empty(); word = nextWord(line)) corners_.push_back(vertex(word));
    if (corners_.size() < 3) error("a face has {} corners, at least 3 are needed", corners_.size());
    for (size_t i = 2; i < corners_.size(); ++i) mesh_.triangles.push_back({corners_[0], corners_[i - 1], corners_[i]});
}

Mesh ObjReader::read(std::string_view text) {
    while (!text.empty()) {
        ++line_;
        std::string_view line = nextLine(text);
        line = line.substr(0, line.find('#'));
        const std::string_view keyword = nextWord(line);
        // Braced lists evaluate from left to right.
        if (keyword == "v") {
            positions_.push_back(Vec3f{coordinate(line), coordinate(line), coordinate(line)});
        } else if (keyword == "vn") {
            normals_.push_back(Vec3f{coordinate(line), coordinate(line), coordinate(line)});
        } else if (keyword == "vt") {
            const Vec2f uv{coordinate(line), coordinate(line)};
            texcoords_.push_back(flipTexCoords_ ? Vec2f(uv.x, 1 - uv.y) : uv);
        } else if (keyword == "f") {
            face(line);
        }
    }
    if (!texcoords_.empty()) mesh_.texcoords.resize(mesh_.positions.size(), Vec2f(0.0f));
    if (!normals_.empty()) mesh_.normals.resize(mesh_.positions.size(), Vec3f(0.0f));
    return std::move(mesh_);
}

}  // namespace

Mesh readObj(std::string_view bytes, std::string_view name, bool flipTexCoords) {
    return ObjReader(name, flipTexCoords).read(bytes);
}

}  // namespace ulam
