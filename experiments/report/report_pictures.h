#pragma once
// What a page holds of the images and chains of a run, small enough together.

#include <filesystem>
#include <string>

#include "core/config/json.h"

namespace ulam {

struct PagePictures {
    Json cells;            ///< by cell: numbers of its pictures, maps, images of techniques and chains
    Json sizes;            ///< by number: width, height, and how a map lies on its image
    std::string elements;  ///< HTML: one element for each number, with base64
    int shrink = 1;        ///< edge of the blocks of pixels that became one
    bool exact = true;     ///< all pictures are RGB9E5; else those of replicates and references are JPEG
};

/// Of the cells of summary.json, from the files below RUN_DIR; what is not there is left out. `metric` is the primary
/// one, `room` what the base64 of all may take, in bytes.
PagePictures gatherPictures(const std::filesystem::path& runDir, const Json& cells, const std::string& metric,
                            double room);

}  // namespace ulam
