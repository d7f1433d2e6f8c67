#include "core/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/memory.h"

namespace ulam {
namespace {

std::string reason(int error) {
    return std::generic_category().message(error);
}

/// An open file, closed at the end of its scope.
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    int number() const { return number_; }
    /// False with errno where the system reports a late write error. Interrupted, a file is closed all the same.
    bool close() { return ::close(std::exchange(number_, -1)) == 0 || errno == EINTR; }

private:
    int number_;
};

[[noreturn]] void failToWrite(const std::filesystem::path& path, int error) {
    fail(ExitCode::CannotWrite, "cannot write {}: {}", path.string(), reason(error));
}

[[noreturn]] void failToRead(const std::filesystem::path& path, int error) {
    const std::string message = fmt::format("cannot read {}: {}", path.string(), reason(error));
    if (error == ENOENT || error == ENOTDIR || error == EISDIR) throw Error(ExitCode::InputMissing, message);
    throw UnreadableFile(ExitCode::InputMissing, message);
}

/// Zero, or the error.
int flush(int file) {
    while (::fsync(file) != 0) {
        // Pipes and devices have nothing to flush and say EINVAL or ENOTSUP.
        if (errno == EINVAL || errno == ENOTSUP) return 0;
        if (errno != EINTR) return errno;
    }
    return 0;
}

/// Zero, or the error.
int writeAll(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

int writeFlushClose(Descriptor& file, std::span<const std::string_view> parts) {
    for (const std::string_view part : parts)
        if (const int error = writeAll(file.number(), part)) return error;
    if (const int error = flush(file.number())) return error;
    return file.close() ? 0 : errno;
}

/// The file behind symbolic links, or the path itself where there is none yet.
std::filesystem::path behindLinks(const std::filesystem::path& path) {
    std::error_code error;
    auto target = path;
    for (int step = 0; step < 40 && std::filesystem::is_symlink(target, error); ++step) {
        const auto next = std::filesystem::read_symlink(target, error);
        if (error) failToWrite(path, error.value());
        target = target.parent_path() / next;
    }
    if (std::filesystem::is_symlink(target, error)) failToWrite(path, ELOOP);
    return target;
}

std::string temporaryNameOf(pid_t process, unsigned number) {
    return fmt::format(".ulam-{}-{}-{}.tmp", hostName(), process, number);
}

/// A temporary file's name of this host whose process has ended. Its number may be ours by now.
bool isAbandoned(const std::string& name) {
    const std::string prefix = fmt::format(".ulam-{}-", hostName());
    if (!name.starts_with(prefix)) return false;
    const char* const end = name.data() + name.size();
    pid_t process = 0;
    unsigned number = 0;
    const char* const dash = std::from_chars(name.data() + prefix.size(), end, process).ptr;
    if (dash == end || process <= 0) return false;
    std::from_chars(dash + 1, end, number);
    if (name != temporaryNameOf(process, number)) return false;
    return process == ::getpid() || (::kill(process, 0) != 0 && errno == ESRCH);
}

}  // namespace

int openFile(const std::filesystem::path& path, int flags) {
    int number = -1;
    do number = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    while (number < 0 && errno == EINTR);
    return number;
}

std::string readFile(const std::filesystem::path& path, std::size_t maxBytes) {
    const Descriptor file(openFile(path, O_RDONLY));
    if (file.number() < 0) failToRead(path, errno);
    std::string bytes;
    struct stat status {};
    if (::fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode)) {
        const std::size_t size = std::min(maxBytes, static_cast<std::size_t>(status.st_size));
        requireMemoryToRead(path.string(), {"the file", double(size), "a smaller file"});
        bytes.reserve(size);
    }
    char block[1 << 16];
    for (;;) {
        const ssize_t count = ::read(file.number(), block, sizeof block);
        if (count == 0) return bytes;
        if (count < 0) {
            if (errno == EINTR) continue;
            failToRead(path, errno);
        }
        if (static_cast<std::size_t>(count) > maxBytes - bytes.size())
            fail(ExitCode::InvalidConfig, "{} holds more than {} bytes", path.string(), maxBytes);
        bytes.append(block, static_cast<std::size_t>(count));
    }
}

void writeFileAtomically(const std::filesystem::path& path, std::string_view bytes) {
    writeFileAtomically(path, std::span(&bytes, 1));
}

void writeFileAtomically(const std::filesystem::path& path, std::span<const std::string_view> parts) {
    const std::filesystem::path target = behindLinks(path);
    struct stat status {};
    const bool exists = ::stat(target.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) failToWrite(path, EISDIR);
    if (exists && !S_ISREG(status.st_mode)) {
        Descriptor file(openFile(target, O_WRONLY));
        if (file.number() < 0) failToWrite(path, errno);
        if (const int error = writeFlushClose(file, parts)) failToWrite(path, error);
        return;
    }

    const auto folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
    std::filesystem::path temporary;
    int number = -1;
    do {
        temporary = folder / temporaryName();
        number = openFile(temporary, O_WRONLY | O_CREAT | O_EXCL);
    } while (number < 0 && errno == EEXIST);
    Descriptor file(number);
    if (number < 0) failToWrite(path, errno);

    int error = writeFlushClose(file, parts);
    if (!error && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error) {
        ::unlink(temporary.c_str());
        failToWrite(path, error);
    }
    // The new name itself reaches the disk with the folder; not every file system can flush one, and the data is safe.
    const Descriptor directory(openFile(folder, O_RDONLY | O_DIRECTORY));
    if (directory.number() >= 0) flush(directory.number());
}

void requireReadable(const std::filesystem::path& path) {
    if (Descriptor(openFile(path, O_RDONLY)).number() < 0) failToRead(path, errno);
}

std::string hostName() {
    char name[256] = {};
    if (::gethostname(name, sizeof name - 1) != 0) return "unknown";
    for (char* c = name; *c; ++c)
        if (!std::isalnum(static_cast<unsigned char>(*c)) && *c != '.' && *c != '-') *c = '_';
    return name;
}

std::string temporaryName() {
    // Not made of the final name, which may be as long as a name can be; taken names are left over from a killed process.
    static std::atomic<unsigned> counter = 0;
    return temporaryNameOf(::getpid(), counter++);
}

void removeTemporaries(const std::filesystem::path& folder, Below below) {
    namespace fs = std::filesystem;
    std::error_code error, ignored;
    std::vector<fs::path> abandoned;
    fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
        const bool found = isAbandoned(entry->path().filename().string());
        if (found) abandoned.push_back(entry->path());
        if (found || below == Below::No) entry.disable_recursion_pending();
    }
    for (const fs::path& path : abandoned) fs::remove_all(path, ignored);
}

}  // namespace ulam
