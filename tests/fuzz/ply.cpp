#include "core/scene/mesh_io.h"
#include "tests/fuzz/target.h"

using namespace ulam;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    tolerateErrors("mesh.ply, byte", [&] {
        const Mesh mesh = readPly(bytesOf(data, size), "mesh.ply");
        require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
        require(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size());
        const Mesh again = readPly(plyBytes(mesh), "mesh.ply");
        require(again.positions.size() == mesh.positions.size() && again.triangles == mesh.triangles);
    });
    return 0;
}
