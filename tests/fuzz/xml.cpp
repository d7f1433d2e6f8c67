#include "core/scene/mitsuba/xml.h"
#include "tests/fuzz/scene_files.h"

using namespace ulam;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const MemoryFolder folder;
    static const bool prepared = [] {
        folder.write("part.xml", R"(<scene version="0.6.0"><bsdf type="diffuse" id="grey"/></scene>)");
        folder.write("curve.spd", "400 0.5\n700 0.7\n");
        return true;
    }();
    require(prepared);
    const std::filesystem::path file = folder.write("scene.xml", bytesOf(data, size));
    for (const bool lenient : {false, true})
        tolerateErrors(".xml", [&] { checkDocument(readMitsubaXml(file, {{}, lenient})); });
    return 0;
}
