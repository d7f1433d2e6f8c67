#pragma once
// What the fuzzing programs share. The only error that a reader may give is ulam::Error; whatever else it does ends the program.

#include <stdlib.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace ulam {

inline std::string_view bytesOf(const uint8_t* data, size_t size) { return {reinterpret_cast<const char*>(data), size}; }

/// Runs a reader. An error must say something, and must say where.
template <class Function>
void tolerateErrors(std::string_view name, Function&& read) {
    try {
        read();
    } catch (const Error& error) {
        if (std::string_view(error.what()).find(name) == std::string_view::npos) {
            fprintf(stderr, "the message does not name %s: %s\n", std::string(name).c_str(), error.what());
            abort();
        }
    }
}

/// A condition on what a reader returned.
inline void require(bool condition) {
    if (!condition) abort();
}

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

}  // namespace ulam
