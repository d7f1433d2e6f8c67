// Mitsuba's .serialized meshes, made here by hand.

#include "core/scene/mesh_io.h"
#include "tests/support/error_of.h"
#include "tests/core/scene/load_text.h"

#include <zlib.h>

#include <cstring>

using namespace ulam;

namespace {

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string compressed(const std::string& bytes) {
    std::string result(compressBound(bytes.size()), '\0');
    uLongf size = result.size();
    REQUIRE(compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) == Z_OK);
    result.resize(size);
    return result;
}

/// One triangle, `shift` along x.
template <class T>
std::string triangle(uint16_t version, uint32_t flags, T shift) {
    std::string data;
    append(data, uint32_t(flags | (sizeof(T) == 8 ? 0x2000 : 0x1000)));
    if (version == 4) data += std::string("corner\0", 7);
    append(data, uint64_t(3)), append(data, uint64_t(1));
    for (const std::array<T, 3> p : {std::array<T, 3>{shift, 0, 0}, {T(shift + 1), 0, 0}, {shift, 1, 0}})
        for (const T x : p) append(data, x);
    if (flags & 1)
        for (int i = 0; i < 3; ++i)
            for (const T x : {T(0), T(0), T(1)}) append(data, x);
    if (flags & 2)
        for (const T x : {T(0), T(0), T(1), T(0), T(0), T(1)}) append(data, x);
    if (flags & 8)
        for (int i = 0; i < 9; ++i) append(data, T(0.5));
    for (const uint32_t i : {0u, 1u, 2u}) append(data, i);
    std::string bytes;
    append(bytes, uint16_t(0x041C)), append(bytes, version);
    return bytes + compressed(data);
}

std::string file(uint16_t version, const std::vector<std::string>& meshes) {
    std::string bytes, list;
    for (const std::string& mesh : meshes) {
        if (version == 3) append(list, uint32_t(bytes.size()));
        else append(list, uint64_t(bytes.size()));
        bytes += mesh;
    }
    bytes += list;
    append(bytes, uint32_t(meshes.size()));
    return bytes;
}

}  // namespace

TEST_CASE("both versions and precisions, with and without normals, texture coordinates and colours") {
    for (const uint16_t version : {uint16_t(3), uint16_t(4)})
        for (const uint32_t flags : {0u, 1u, 2u, 11u, 16u}) {
            const std::string bytes = file(version, {triangle<float>(version, 0, 5), triangle<double>(version, flags, 0.25)});
            const SerializedMesh second = readSerialized(bytes, "a.serialized", 1);
            CHECK(second.faceNormals == (flags == 16));
            const Mesh& mesh = second.mesh;
            REQUIRE(mesh.positions.size() == 3);
            CHECK(mesh.positions[1] == Vec3f(1.25f, 0, 0));
            CHECK(mesh.positions[2] == Vec3f(0.25f, 1, 0));
            CHECK(mesh.normals.size() == (flags & 1 ? 3 : 0));
            CHECK(mesh.texcoords.size() == (flags & 2 ? 3 : 0));
            if (flags & 2) CHECK(mesh.texcoords[1] == Vec2f(1, 0));
            CHECK(mesh.triangles == std::vector<std::array<uint32_t, 3>>{{0, 1, 2}});
            CHECK(readSerialized(bytes, "a.serialized", 0).mesh.positions[0].x == 5);
        }
}

TEST_CASE("a serialized mesh as a shape of a scene") {
    const SceneFolder folder("serialized");
    folder.write("a.serialized", file(4, {triangle<float>(4, 0, 0), triangle<float>(4, 1, 7)}));
    const Scene scene = loadText(sceneWith(R"("s": {"type": "serialized", "filename": "a.serialized", "shape_index": 1})"), folder.path);
    CHECK(std::get<Mesh>(scene.shapes[0].geometry).positions[0].x == 7);
    CHECK(mentions(errorOf(sceneWith(R"("s": {"type": "serialized", "filename": "a.serialized", "shape_index": 2})"), ExitCode::InvalidConfig, folder.path),
                   "has 2 meshes"));
}

TEST_CASE("damaged files and files that promise more than they hold are refused") {
    const std::string good = file(4, {triangle<float>(4, 3, 0)});
    const auto attempt = [](const std::string& bytes) { return errorOf([&] { readSerialized(bytes, "a.serialized", 0); }); };
    CHECK(attempt(good).code == ExitCode::Done);
    for (size_t n = 0; n < good.size(); ++n) CHECK(attempt(good.substr(0, n)).code == ExitCode::InvalidConfig);
    for (size_t i = 0; i < good.size(); ++i) {
        std::string broken = good;
        broken[i] = char(broken[i] ^ 0x55);
        const Complaint complaint = attempt(broken);  // or read, where only a number changed
        CHECK((complaint.code == ExitCode::Done || complaint.code == ExitCode::InvalidConfig));
    }
    std::string data;
    append(data, uint32_t(0x1000)), data += '\0';
    append(data, uint64_t(4'000'000'000)), append(data, uint64_t(1) << 60);
    std::string bytes;
    append(bytes, uint16_t(0x041C)), append(bytes, uint16_t(4));
    CHECK(attempt(file(4, {bytes + compressed(data)})).has("too short for 4000000000 vertices"));
}
