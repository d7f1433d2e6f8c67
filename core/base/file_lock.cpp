#include "core/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
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
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    const std::string text = fmt::format("{} {}\n", ::getpid(), host);
    if (::ftruncate(file, 0) != 0) return errno;
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = ::pwrite(file, text.data() + done, text.size() - done, static_cast<off_t>(done));
        if (written < 0 && errno != EINTR) return errno;
        if (written > 0) done += static_cast<std::size_t>(written);
    }
    return 0;
}

}  // namespace

FileLock FileLock::claim(const std::filesystem::path& file) {
    FileLock claimed(openFile(file, O_RDWR | O_CREAT));
    if (!claimed.held()) failToLock(file, errno);
    const int error = lock(claimed.descriptor_, LOCK_EX | LOCK_NB);
    if (error == EWOULDBLOCK)
        fail(ExitCode::CannotWrite, "{} is in use by {}", file.parent_path().string(), holder(claimed.descriptor_));
    if (error) return FileLock(-1);
    if (const int trouble = writeHolder(claimed.descriptor_)) failToLock(file, trouble);
    return claimed;
}

FileLock FileLock::await(const std::filesystem::path& folder) {
    FileLock awaited(openFile(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY));
    if (awaited.held() && lock(awaited.descriptor_, LOCK_EX) != 0) return FileLock(-1);
    return awaited;
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace ulam
