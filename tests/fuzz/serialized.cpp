#include "core/scene/mesh_io.h"
#include "tests/fuzz/target.h"

using namespace ulam;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    for (const int index : {0, 1, -1})
        tolerateErrors("mesh.serialized", [&] {
            const Mesh mesh = readSerialized(bytesOf(data, size), "mesh.serialized", index).mesh;
            require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
            require(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size());
        });
    return 0;
}
