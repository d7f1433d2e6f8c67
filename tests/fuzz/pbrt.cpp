#include "core/scene/pbrt/pbrt.h"
#include "tests/fuzz/scene_files.h"

using namespace ulam;

namespace {

/// Each level makes four triangles of one: at the limits of the reader, a single file takes longer here than all others.
bool subdividesMuch(std::string_view text) {
    if (text.find("loopsubdiv") == text.npos) return false;
    for (size_t at = text.find("levels"); at != text.npos; at = text.find("levels", at + 1)) {
        const size_t digit = std::min(text.find_first_of("0123456789", at), text.size());
        if (std::atoi(std::string(text.substr(digit, 3)).c_str()) > 4) return true;
    }
    return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const MemoryFolder folder;
    static const bool prepared = [] {
        folder.write("part.pbrt", "Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\nShape \"sphere\"\n");
        folder.write("mesh.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
        folder.write("curve.spd", "400 0.5\n700 0.7\n");
        return true;
    }();
    require(prepared);
    if (subdividesMuch(bytesOf(data, size))) return 0;
    const std::filesystem::path file = folder.write("scene.pbrt", bytesOf(data, size));
    for (const bool lenient : {false, true})
        tolerateErrors(".pbrt", [&] { checkDocument(readPbrt(file, lenient)); });
    return 0;
}
