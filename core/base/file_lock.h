#pragma once
// Advisory locks between processes. The system releases them when the process ends, however it ends.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace ulam {

/// What becomes of the file of a lock that is released.
enum class LockFile { Stays, Goes };

/// A lock that is held until the object or the process is gone. Where the file system knows no locks none is held, and
/// `held()` says so.
class FileLock {
public:
    /// The lock of a file, which is made, and holds "PROCESS HOST" of who has or had the lock. Fails with CannotWrite
    /// where another process has it, saying that this process uses `what`, and where the file cannot be written. Where
    /// its name is too long for the file system none is held.
    static FileLock claim(const std::filesystem::path& file, const std::string& what, LockFile released = LockFile::Stays);
    /// The lock of a folder, as soon as no other process has it. It leaves no file.
    static FileLock await(const std::filesystem::path& folder);
    /// The lock of a folder; nothing where another process has it.
    static std::optional<FileLock> attempt(const std::filesystem::path& folder);

    ~FileLock();
    FileLock(FileLock&& other) noexcept
        : descriptor_(std::exchange(other.descriptor_, -1)), removed_(std::exchange(other.removed_, {})) {}
    FileLock& operator=(FileLock&&) = delete;

    bool held() const { return descriptor_ >= 0; }

private:
    explicit FileLock(int descriptor) : descriptor_(descriptor) {}

    int descriptor_;
    std::filesystem::path removed_;  ///< when it is released; none: empty
};

}  // namespace ulam
