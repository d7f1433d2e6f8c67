#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/scene/mesh_io.h"

namespace ulam {
namespace {

template <class T>
void append(std::string& bytes, T value) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
}

void appendFloats(std::string& bytes, std::initializer_list<float> values) {
    for (const float value : values) append(bytes, value);
}

}  // namespace

std::string plyBytes(const Mesh& mesh) {
    const bool hasNormals = !mesh.normals.empty(), hasTexcoords = !mesh.texcoords.empty();
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n{}{}"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.size(), hasNormals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
        hasTexcoords ? "property float u\nproperty float v\n" : "", mesh.triangles.size());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3f& p = mesh.positions[i];
        appendFloats(bytes, {p.x, p.y, p.z});
        if (hasNormals) appendFloats(bytes, {mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z});
        if (hasTexcoords) appendFloats(bytes, {mesh.texcoords[i].x, mesh.texcoords[i].y});
    }
    for (const auto& triangle : mesh.triangles) {
        append(bytes, uint8_t(3));
        for (const uint32_t vertex : triangle) append(bytes, vertex);
    }
    return bytes;
}

}  // namespace ulam
