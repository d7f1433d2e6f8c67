#include "core/scene/mesh_io.h"
#include "tests/fuzz/target.h"

using namespace ulam;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    tolerateErrors("mesh.obj:", [&] {
        const Mesh mesh = readObj(bytesOf(data, size), "mesh.obj", size % 2 == 1);
        require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
        require(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size());
        for (const auto& triangle : mesh.triangles)
            for (const uint32_t vertex : triangle) require(vertex < mesh.positions.size());
    });
    return 0;
}
