// Faults of the file system, for tests: a library for LD_PRELOAD that counts what a program does with the files below a
// folder, and lets a chosen call fail.
//
//     ULAM_FAULT_BELOW=FOLDER           the files that count; an absolute path without links
//     ULAM_FAULT_LOG=FILE               a line "operation path" for each call that counts ("rename from to")
//     ULAM_FAULT=operation:n:fault[:sticky]   the n-th call of the operation, from 1, has the fault; sticky: all later ones too
//
// Operations: open (for writing), open-read, open-folder, write, fsync, fsync-folder, close (of what was open for writing and
// still has a name), rename, mkdir, ftruncate, unlink, flock. Faults: names of errors as below, SHORT (half of a write is
// done), KILL (SIGKILL before the call). What the C library does inside itself (fwrite) cannot be caught so.

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <string>
#include <string_view>

namespace {

constexpr int kShort = -1, kKill = -2;

struct Name {
    std::string_view name;
    int error;
};
constexpr Name kFaults[] = {{"ENOSPC", ENOSPC}, {"EIO", EIO},         {"EINTR", EINTR},   {"EROFS", EROFS},
                            {"EACCES", EACCES}, {"ENOLCK", ENOLCK}, {"SHORT", kShort}, {"KILL", kKill}};

const char* variable(const char* name) {
    const char* value = ::getenv(name);
    return value ? value : "";
}

struct Plan {
    std::string below = variable("ULAM_FAULT_BELOW"), operation;
    long place = 0;
    int fault = 0;
    bool sticky = false;
    int log = -1;

    Plan() {
        const std::string text = variable("ULAM_FAULT");
        const auto first = text.find(':'), second = text.find(':', first + 1), third = text.find(':', second + 1);
        if (second != std::string::npos) {
            operation = text.substr(0, first);
            place = std::atol(text.c_str() + first + 1);
            const std::string name = text.substr(second + 1, third == std::string::npos ? third : third - second - 1);
            sticky = third != std::string::npos;
            for (const Name& known : kFaults)
                if (known.name == name) fault = known.error;
        }
        if (*variable("ULAM_FAULT_LOG"))
            log = int(::syscall(SYS_openat, AT_FDCWD, variable("ULAM_FAULT_LOG"), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
    }
};

const Plan& plan() {
    static const Plan* const made = new Plan;  // never destroyed: calls come until the very end
    return *made;
}

std::string nameOf(int file) {
    char link[40], target[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = ::readlink(link, target, sizeof target);
    return {target, std::size_t(length > 0 ? length : 0)};
}

std::string absolute(int folder, const char* path) {
    if (*path == '/') return path;
    if (folder != AT_FDCWD) return nameOf(folder) + "/" + path;
    char current[4096];
    return std::string(::getcwd(current, sizeof current) ? current : "") + "/" + path;
}

/// The fault that the call is to have, or 0. Where it counts it is logged.
int faultOf(std::string_view operation, const std::string& path, const std::string& to = "") {
    const Plan& p = plan();
    if (p.below.empty() || !(to.empty() ? path : to).starts_with(p.below)) return 0;
    if (p.log >= 0) {
        const std::string line = std::string(operation) + " " + path + (to.empty() ? "" : " " + to) + "\n";
        [[maybe_unused]] const long written = ::syscall(SYS_write, p.log, line.data(), line.size());
    }
    if (operation != p.operation) return 0;
    static std::atomic<long> calls = 0;
    const long call = ++calls;
    if (call != p.place && !(p.sticky && call > p.place)) return 0;
    if (p.fault == kKill) ::raise(SIGKILL);
    return p.fault;
}

std::string_view openOperation(int flags) {
    if (flags & O_DIRECTORY) return "open-folder";
    return (flags & (O_WRONLY | O_RDWR | O_CREAT)) ? "open" : "open-read";
}

/// The next function of the name.
template <class Function>
Function* next(Function*, const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}
#define NEXT(function)                                              \
    [] {                                                            \
        static const auto found = next(&::function, #function);     \
        return found;                                               \
    }()

template <class Result = int>
Result failing(int error) {
    errno = error;
    return Result(-1);
}

int openAt(int folder, const char* path, int flags, mode_t mode) {
    if (const int fault = faultOf(openOperation(flags), absolute(folder, path))) return failing(fault);
    return int(::syscall(SYS_openat, folder, path, flags, mode));
}

mode_t modeOf(int flags, va_list arguments) {
    return (flags & (O_CREAT | O_TMPFILE)) ? va_arg(arguments, mode_t) : 0;
}

bool isFolder(int file) {
    struct stat status;
    return ::fstat(file, &status) == 0 && S_ISDIR(status.st_mode);
}

FILE* openStream(const char* path, const char* mode, FILE* (*original)(const char*, const char*)) {
    const bool reads = *mode == 'r' && !::strchr(mode, '+');
    if (const int fault = faultOf(reads ? "open-read" : "open", absolute(AT_FDCWD, path))) {
        errno = fault;
        return nullptr;
    }
    return original(path, mode);
}

}  // namespace

#define WITH_MODE(call)                       \
    va_list arguments;                        \
    va_start(arguments, flags);               \
    const mode_t mode = modeOf(flags, arguments); \
    va_end(arguments);                        \
    return call

extern "C" {

int open(const char* path, int flags, ...) { WITH_MODE(openAt(AT_FDCWD, path, flags, mode)); }
int open64(const char* path, int flags, ...) { WITH_MODE(openAt(AT_FDCWD, path, flags, mode)); }
int openat(int folder, const char* path, int flags, ...) { WITH_MODE(openAt(folder, path, flags, mode)); }
int openat64(int folder, const char* path, int flags, ...) { WITH_MODE(openAt(folder, path, flags, mode)); }
int creat(const char* path, mode_t mode) { return openAt(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode); }
int creat64(const char* path, mode_t mode) { return openAt(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode); }
FILE* fopen(const char* path, const char* mode) { return openStream(path, mode, NEXT(fopen)); }
FILE* fopen64(const char* path, const char* mode) { return openStream(path, mode, NEXT(fopen64)); }

ssize_t write(int file, const void* bytes, size_t count) {
    const int fault = faultOf("write", nameOf(file));
    if (fault == kShort) count = (count + 1) / 2;
    if (fault > 0) return failing<ssize_t>(fault);
    return ::syscall(SYS_write, file, bytes, count);
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t offset) {
    const int fault = faultOf("write", nameOf(file));
    if (fault == kShort) count = (count + 1) / 2;
    if (fault > 0) return failing<ssize_t>(fault);
    return ::syscall(SYS_pwrite64, file, bytes, count, offset);
}

ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t offset) { return ::pwrite(file, bytes, count, offset); }

ssize_t writev(int file, const iovec* pieces, int count) {
    const int fault = faultOf("write", nameOf(file));
    if (fault == kShort) return ::syscall(SYS_write, file, pieces[0].iov_base, (pieces[0].iov_len + 1) / 2);
    if (fault > 0) return failing<ssize_t>(fault);
    return ::syscall(SYS_writev, file, pieces, count);
}

int fsync(int file) {
    if (const int fault = faultOf(isFolder(file) ? "fsync-folder" : "fsync", nameOf(file))) return failing(fault);
    return int(::syscall(SYS_fsync, file));
}

int fdatasync(int file) {
    if (const int fault = faultOf("fsync", nameOf(file))) return failing(fault);
    return int(::syscall(SYS_fdatasync, file));
}

/// The file is closed all the same, as in Linux.
int close(int file) {
    const int flags = ::fcntl(file, F_GETFL);
    struct stat status {};
    const bool counts = flags >= 0 && (flags & O_ACCMODE) != O_RDONLY && ::fstat(file, &status) == 0 && status.st_nlink > 0;
    const int fault = counts ? faultOf("close", nameOf(file)) : 0;
    const int result = int(::syscall(SYS_close, file));
    return fault ? failing(fault) : result;
}

int renameat2(int fromFolder, const char* from, int toFolder, const char* to, unsigned flags) {
    if (const int fault = faultOf("rename", absolute(fromFolder, from), absolute(toFolder, to))) return failing(fault);
    return int(::syscall(SYS_renameat2, fromFolder, from, toFolder, to, flags));
}

int rename(const char* from, const char* to) { return ::renameat2(AT_FDCWD, from, AT_FDCWD, to, 0); }
int renameat(int fromFolder, const char* from, int toFolder, const char* to) {
    return ::renameat2(fromFolder, from, toFolder, to, 0);
}

int mkdir(const char* path, mode_t mode) {
    if (const int fault = faultOf("mkdir", absolute(AT_FDCWD, path))) return failing(fault);
    return int(::syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}

int ftruncate(int file, off_t length) {
    if (const int fault = faultOf("ftruncate", nameOf(file))) return failing(fault);
    return int(::syscall(SYS_ftruncate, file, length));
}

int ftruncate64(int file, off64_t length) { return ::ftruncate(file, length); }

int unlinkat(int folder, const char* path, int flags) {
    if (const int fault = faultOf("unlink", absolute(folder, path))) return failing(fault);
    return int(::syscall(SYS_unlinkat, folder, path, flags));
}

int unlink(const char* path) { return ::unlinkat(AT_FDCWD, path, 0); }
int rmdir(const char* path) { return ::unlinkat(AT_FDCWD, path, AT_REMOVEDIR); }
int remove(const char* path) {
    const int result = ::unlinkat(AT_FDCWD, path, 0);
    return result != 0 && errno == EISDIR ? ::unlinkat(AT_FDCWD, path, AT_REMOVEDIR) : result;
}

int flock(int file, int operation) {
    if (const int fault = faultOf("flock", nameOf(file))) return failing(fault);
    return int(::syscall(SYS_flock, file, operation));
}

}  // extern "C"
