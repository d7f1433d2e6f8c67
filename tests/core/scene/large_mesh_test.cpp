// The same mesh from each kind of file; with --full one of ten million triangles, and what loading it takes
// (docs/performance.md has the figures).

#include <zlib.h>

#include <chrono>
#include <iostream>

#include "core/base/file.h"
#include "core/scene/mesh_io.h"
#include "tests/core/scene/load_text.h"
#include "tests/support/level.h"

using namespace ulam;

namespace {

/// A hilly square of side² cells, two triangles each.
Mesh hills(uint32_t side) {
    Mesh mesh;
    for (uint32_t i = 0; i <= side; ++i)
        for (uint32_t j = 0; j <= side; ++j) {
            const float x = 2 * float(i) / float(side) - 1, y = 2 * float(j) / float(side) - 1;
            mesh.positions.emplace_back(x, y, 0.1f * std::sin(13 * x) * std::cos(11 * y) + 0.01f * std::sin(131 * x + 17 * y));
        }
    for (uint32_t i = 0; i < side; ++i)
        for (uint32_t j = 0; j < side; ++j) {
            const uint32_t a = i * (side + 1) + j, b = a + side + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

std::string objText(const Mesh& mesh) {
    fmt::memory_buffer text;
    for (const Vec3f& p : mesh.positions) fmt::format_to(std::back_inserter(text), "v {} {} {}\n", p.x, p.y, p.z);
    for (const auto& [i, j, k] : mesh.triangles) fmt::format_to(std::back_inserter(text), "f {} {} {}\n", i + 1, j + 1, k + 1);
    return fmt::to_string(text);
}

std::string serializedBytes(const Mesh& mesh) {
    std::string data;
    const auto append = [](std::string& bytes, const auto* values, size_t count) { bytes.append(reinterpret_cast<const char*>(values), count * sizeof *values); };
    const uint32_t flags = 0x1000, meshes = 1;
    const uint64_t sizes[2] = {mesh.positions.size(), mesh.triangles.size()}, begin = 0;
    const uint16_t version[2] = {0x041C, 4};
    append(data, &flags, 1);
    data += std::string("hills\0", 6);
    append(data, sizes, 2);
    append(data, mesh.positions.data(), mesh.positions.size());
    append(data, mesh.triangles.data(), mesh.triangles.size());
    std::string bytes, packed(compressBound(data.size()), '\0');
    uLongf size = packed.size();
    REQUIRE(compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(data.data()), data.size(), 1) == Z_OK);
    append(bytes, version, 2);
    bytes.append(packed.data(), size);
    append(bytes, &begin, 1);
    append(bytes, &meshes, 1);
    return bytes;
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Memory of the process in MB: the most since the last reset, as Linux counts it.
double peakMegabytes() {
    const std::string status = readFile("/proc/self/status");
    return std::stod(status.substr(status.find("VmHWM:") + 6)) / 1000;
}
void resetPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }

}  // namespace

TEST_CASE("large meshes: every kind of file gives the mesh, quickly") {
    const SceneFolder folder("large_mesh_test");
    const uint32_t side = fullLevel() ? 2237 : 150;
    const Mesh mesh = hills(side);
    folder.write("hills.ply", plyBytes(mesh));
    folder.write("hills.obj", objText(mesh));
    folder.write("hills.serialized", serializedBytes(mesh));
    for (const char* kind : {"ply", "serialized", "obj"})
        for (const bool smooth : {false, true}) {
            const std::string file = fmt::format("hills.{}", kind);
            INFO(file << (smooth ? ", smooth" : ", flat"));
            const std::string text = sceneWith(fmt::format(R"("m": {{"type": "{}", "filename": "{}", "face_normals": {}}})", kind, file, !smooth));
            resetPeak();
            const double before = peakMegabytes(), begin = now();
            const Scene scene = loadText(text, folder.path);
            const double loaded = now() - begin, peak = peakMegabytes() - before;

            const Mesh& read = std::get<Mesh>(scene.shapes[0].geometry);
            REQUIRE(read.triangles.size() == mesh.triangles.size());
            // An OBJ's vertices are numbered as its faces come to them.
            size_t differing = 0;
            for (size_t t = 0; t < mesh.triangles.size(); ++t)
                for (size_t corner = 0; corner < 3; ++corner) differing += read.positions[read.triangles[t][corner]] != mesh.positions[mesh.triangles[t][corner]];
            CHECK(differing == 0);
            CHECK(read.positions.size() == mesh.positions.size());
            CHECK(read.normals.size() == (smooth ? mesh.positions.size() : 0));
            if (!fullLevel()) continue;

            // What cannot be done without: the file's bytes and the acceleration structure.
            const double readBegin = now();
            const size_t bytes = readFile(folder.path / file).size();
            const double buildBegin = now();
            const RayTracer again(scene.shapes);
            const double reading = buildBegin - readBegin, building = now() - buildBegin;
            std::cout << fmt::format("{} triangles, {}, {}: {:.0f} MB read in {:.2f} s, built in {:.2f} s, loaded in {:.2f} s ({:.2f} of both), {:.0f} MB at most\n",
                                     mesh.triangles.size(), file, smooth ? "smooth" : "flat", double(bytes) * 1e-6, reading, building, loaded,
                                     loaded / (reading + building), peak);
            CHECK(loaded < 2 * (reading + building));
        }
}
