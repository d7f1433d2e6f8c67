#include "core/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "core/base/error.h"
#include "core/base/file.h"

namespace ulam {
namespace {

/// Zero, or the error.
int lock(int file, int operation) {
    while (::flock(file, operation) != 0)
        if (errno != EINTR) return errno;
    return 0;
}

[[noreturn]] void failToLock(const std::filesystem::path& file, int error) {
    fail(ExitCode::CannotWrite, "cannot write {}: {}", file.string(), std::generic_category().message(error));
}

/// "process 12 on host", from what the holder wrote; it may not have come to that yet.
std::string holder(int file) {
    char text[300];
    ssize_t length = ::pread(file, text, sizeof text, 0);
    while (length > 0 && text[length - 1] == '\n') --length;
    const std::string words(text, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
    const auto space = words.find(' ');
    if (space == std::string::npos) return "another process";
    return fmt::format("process {} on {}", words.substr(0, space), words.substr(space + 1));
}

int writeHolder(int file) {
    const std::string text = fmt::format("{} {}\n", ::getpid(), hostName());
    if (::ftruncate(file, 0) != 0) return errno;
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = ::pwrite(file, text.data() + done, text.size() - done, static_cast<off_t>(done));
        if (written < 0 && errno != EINTR) return errno;
        if (written > 0) done += static_cast<std::size_t>(written);
    }
    return 0;
}

/// Whether an open file still has its name.
bool isNamed(int file, const std::filesystem::path& name) {
    struct stat opened {}, named {};
    return ::fstat(file, &opened) == 0 && ::stat(name.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

}  // namespace

FileLock FileLock::claim(const std::filesystem::path& file, const std::string& what, LockFile released) {
    for (;;) {
        FileLock claimed(openFile(file, O_RDWR | O_CREAT));
        if (!claimed.held() && errno == ENAMETOOLONG) return claimed;
        if (!claimed.held()) failToLock(file, errno);
        const int error = lock(claimed.descriptor_, LOCK_EX | LOCK_NB);
        if (error == EWOULDBLOCK) fail(ExitCode::CannotWrite, "{} is in use by {}", what, holder(claimed.descriptor_));
        if (error) return FileLock(-1);
        // Who had the lock may have removed the file between the two calls: then others lock a new one.
        if (!isNamed(claimed.descriptor_, file)) continue;
        if (released == LockFile::Goes) claimed.removed_ = file;
        if (const int trouble = writeHolder(claimed.descriptor_)) failToLock(file, trouble);
        return claimed;
    }
}

FileLock FileLock::await(const std::filesystem::path& folder) {
    FileLock awaited(openFile(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY));
    if (awaited.held() && lock(awaited.descriptor_, LOCK_EX) != 0) return FileLock(-1);
    return awaited;
}

std::optional<FileLock> FileLock::attempt(const std::filesystem::path& folder) {
    FileLock attempted(openFile(folder, O_RDONLY | O_DIRECTORY));
    const int error = attempted.held() ? lock(attempted.descriptor_, LOCK_EX | LOCK_NB) : 0;
    if (error == EWOULDBLOCK) return std::nullopt;
    if (error) return FileLock(-1);
    return attempted;
}

FileLock::~FileLock() {
    if (!removed_.empty()) ::unlink(removed_.c_str());  // first: without the lock it may be another's
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace ulam
