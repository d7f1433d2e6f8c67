#include "core/scene/pbrt/pbrt.h"
#include "tests/fuzz/target.h"

using namespace ulam;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const MemoryFolder folder;
    static const bool prepared = [] {
        folder.write("part.pbrt", "Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\nShape \"sphere\"\n");
        folder.write("mesh.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
        folder.write("curve.spd", "400 0.5\n700 0.7\n");
        return true;
    }();
    require(prepared);
    const std::filesystem::path file = folder.write("scene.pbrt", bytesOf(data, size));
    for (const bool lenient : {false, true})
        tolerateErrors(".pbrt:", [&] { dump(readPbrt(file, lenient).json()); });
    return 0;
}
