#include "core/scene/mesh_io.h"

#include <cstring>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/catch.h"
#include "tests/support/error_of.h"

using namespace ulam;

namespace {

std::string complaintAbout(std::invocable auto&& read) {
    const Complaint complaint = errorOf(read);
    INFO(complaint.message);
    CHECK(complaint.code == ExitCode::InvalidConfig);
    return complaint.message;
}
std::string objError(const std::string& text) {
    return complaintAbout([&] { readObj(text, "a.obj", true); });
}
std::string plyError(const std::string& text) {
    return complaintAbout([&] { readPly(text, "a.ply"); });
}

const std::string kSquarePly =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";

template <class T>
void append(std::string& bytes, T value, bool big) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
}

std::string binarySquare(bool big) {
    std::string bytes =
        std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty short z\nproperty float nx\n"
        "property float ny\nproperty float nz\nelement dust 2\nproperty list uchar ushort grains\n"
        "element face 2\nproperty uchar colour\nproperty list uchar uint vertex_index\nend_header\n";
    const double x[] = {0, 1, 1, 0};
    const float y[] = {0, 0, 1, 1};
    for (int i = 0; i < 4; ++i) {
        append(bytes, x[i], big), append(bytes, y[i], big), append(bytes, int16_t(-7), big);
        append(bytes, 0.0f, big), append(bytes, 0.0f, big), append(bytes, 1.0f, big);
    }
    for (int i = 0; i < 2; ++i) {
        append(bytes, uint8_t(i), big);
        for (int k = 0; k < i; ++k) append(bytes, uint16_t(9), big);
    }
    for (const std::array<uint32_t, 3>& t : {std::array<uint32_t, 3>{0, 1, 2}, {0, 2, 3}}) {
        append(bytes, uint8_t(200), big), append(bytes, uint8_t(3), big);
        for (const uint32_t i : t) append(bytes, i, big);
    }
    return bytes;
}

}  // namespace

TEST_CASE("obj: polygons become fans, groups one mesh, indices count from either end") {
    const Mesh mesh = readObj(
        "# a comment\nmtllib none.mtl\no first\nv 0 0 0\nv 1 0 0 1.0\r\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
        "g second\nv 5 5 5e0\n  f -1 -2 1 # a comment\n",
        "a.obj", true);
    REQUIRE(mesh.triangles.size() == 3);
    CHECK(mesh.triangles[1] == std::array<uint32_t, 3>{0, 2, 3});
    CHECK(mesh.positions[mesh.triangles[2][0]] == Vec3f(5, 5, 5));
    CHECK(mesh.positions[mesh.triangles[2][1]] == Vec3f(0, 1, 0));
    CHECK(mesh.normals.empty());
    CHECK(mesh.texcoords.empty());
}

TEST_CASE("obj: vertices are split where normals or texture coordinates differ") {
    const std::string text =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.25\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2//1 3/1\nf 1/1/2 2//1 3/1\n";
    const Mesh mesh = readObj(text, "a.obj", true);
    CHECK(mesh.positions.size() == 4);
    CHECK(mesh.normals[mesh.triangles[1][0]] == Vec3f(0, 1, 0));
    CHECK(mesh.normals[mesh.triangles[0][2]] == Vec3f(0, 0, 0));
    CHECK(mesh.texcoords[mesh.triangles[0][0]] == Vec2f(0.25f, 0.75f));
    CHECK(readObj(text, "a.obj", false).texcoords[0] == Vec2f(0.25f, 0.25f));
}

TEST_CASE("obj: errors name file and line") {
    CHECK(mentions(objError("v 0 0\n"), "a.obj:1"));
    CHECK(mentions(objError("v 0 0 zero\n"), "zero"));
    CHECK(mentions(objError("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "a.obj:4"));
    CHECK(mentions(objError("v 0 0 0\nf 1 1\n"), "2 corners"));
    CHECK(mentions(objError("v 0 0 0\nf 0 1 1\n"), "\"0\""));
    CHECK(mentions(objError("v 0 0 0\nf -2 1 1\n"), "-2"));
    CHECK(mentions(objError("v 0 0 0\nvt 0 0\nvn 0 0 1\nf 1/1/1/1 1 1\n"), "1/1/1/1"));
    CHECK(mentions(objError("v 0 0 0\nf 99999999999999999999 1 1\n"), "vertex"));
}

TEST_CASE("ply: ascii and both binary kinds") {
    const Mesh ascii = readPly(kSquarePly, "a.ply");
    REQUIRE(ascii.triangles.size() == 2);
    CHECK(ascii.triangles[1] == std::array<uint32_t, 3>{0, 2, 3});
    CHECK(ascii.texcoords[2] == Vec2f(1, 1));
    CHECK(ascii.normals.empty());
    for (const bool big : {false, true}) {
        const Mesh binary = readPly(binarySquare(big), "a.ply");
        REQUIRE(binary.positions.size() == 4);
        CHECK(binary.positions[2] == Vec3f(1, 1, -7));
        CHECK(binary.normals[3] == Vec3f(0, 0, 1));
        CHECK(binary.triangles == ascii.triangles);
    }
}

TEST_CASE("ply: a file that announces more than it holds fails before memory is taken") {
    const std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n";
    CHECK(mentions(plyError(header), "too short"));
    std::string list =
        "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint int vertex_indices\nend_header\n";
    append(list, uint32_t(0xffffffff), false);
    CHECK(mentions(plyError(list), "too short"));
    CHECK(mentions(plyError(kSquarePly.substr(0, kSquarePly.size() - 6)), "too short"));
}

TEST_CASE("ply: errors") {
    CHECK(mentions(plyError(""), "begins with"));
    CHECK(mentions(plyError("ply\nformat ascii 1.0\n"), "end_header"));
    CHECK(mentions(plyError("ply\nformat binary 1.0\nend_header\n"), "binary_little_endian"));
    CHECK(mentions(plyError("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n"), "-1"));
    CHECK(mentions(plyError("ply\nformat ascii 1.0\nproperty float x\nend_header\n"), "before the first element"));
    CHECK(mentions(plyError("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n1\n"), "half"));
    CHECK(
        mentions(plyError("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"), "x, y and z"));
    CHECK(mentions(
        plyError("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n2 0 1\n"),
        "2 corners"));
    CHECK(mentions(
        plyError(
            "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 1 -2\n"),
        "-2"));
}

TEST_CASE("ply: vertices in two elements are refused") {
    const std::string text =
        "ply\nformat ascii 1.0\n"
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n";
    CHECK(mentions(plyError(text), "two elements"));
}

TEST_CASE("ply: what is written is read back bit for bit") {
    Random random({5, 6}, 0, 0);
    for (const bool normals : {false, true})
        for (const bool texcoords : {false, true}) {
            Mesh mesh;
            for (int i = 0; i < 300; ++i) {
                const auto number = [&] { return float(std::ldexp(random() - 0.5, random.index(200) - 100)); };
                mesh.positions.emplace_back(number(), number(), number());
                if (normals) mesh.normals.emplace_back(number(), number(), number());
                if (texcoords) mesh.texcoords.emplace_back(number(), number());
                mesh.triangles.push_back({uint32_t(i), uint32_t(random.index(300)), 299});
            }
            const Mesh read = readPly(plyBytes(mesh), "a.ply");
            CHECK(read.positions == mesh.positions);
            CHECK(read.normals == mesh.normals);
            CHECK(read.texcoords == mesh.texcoords);
            CHECK(read.triangles == mesh.triangles);
        }
}

TEST_CASE("damaged mesh files give a mesh or an error") {
    Random random({7, 8}, 0, 0);
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n";
    const std::vector<std::string> originals{obj, kSquarePly, binarySquare(false), binarySquare(true)};
    for (int i = 0; i < 20000; ++i) {
        std::string bytes = originals[size_t(random.index(4))];
        for (int k = random.index(4); k >= 0; --k)
            bytes[size_t(random.index(int(bytes.size())))] = char(random.index(256));
        if (random() < 0.3) bytes.resize(size_t(random.index(int(bytes.size()))));
        try {
            if (i % 2)
                readObj(bytes, "a.obj", true);
            else
                readPly(bytes, "a.ply");
        } catch (const Error&) {
        }
    }
    SUCCEED();
}
