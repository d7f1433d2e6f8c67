#pragma once
// For readers of scenes, whose files name other files.

#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "core/config/json.h"
#include "tests/fuzz/target.h"

namespace ulam {

/// A folder in memory for readers of files that name other files; removed at the end.
class MemoryFolder {
public:
    MemoryFolder() {
        std::string name = std::filesystem::is_directory("/dev/shm") ? "/dev/shm/ulam-fuzz-XXXXXX" : "/tmp/ulam-fuzz-XXXXXX";
        require(mkdtemp(name.data()) != nullptr);
        path_ = name;
    }
    ~MemoryFolder() { std::filesystem::remove_all(path_); }

    std::filesystem::path write(const std::string& name, std::string_view bytes) const {
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

/// All values can be written and placed. Numbers may have become infinite: the loader refuses them with the place.
inline void checkNode(const JsonNode& node) {
    require(!node.where().empty());
    if (node.isObject())
        for (const auto& [name, member] : node.members()) checkNode(member);
}

inline void checkDocument(const JsonDocument& document) {
    document.json().dump();  // fails at what is not UTF-8
    checkNode(document.root());
}

}  // namespace ulam
