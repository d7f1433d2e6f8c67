#include "core/base/file.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "core/base/error.h"
#include "tests/support/catch.h"
#include "tests/support/error_of.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

/// An empty folder that is gone at the end of its scope.
struct Folder {
    Folder() : path(fs::temp_directory_path() / ("ulam-file-test-" + std::to_string(::getpid()))) {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
    std::size_t count() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), {})); }
    fs::path path;
};

}  // namespace

TEST_CASE("what is written is read", "[file]") {
    const Folder folder;
    const fs::path path = folder.path / "a.bin";
    const std::string bytes = std::string(300'000, 'x') + std::string("\0\n\xff", 3);
    writeFileAtomically(path, "old");
    writeFileAtomically(path, bytes);
    CHECK(readFile(path) == bytes);
    writeFileAtomically(path, "");
    CHECK(readFile(path).empty());
    CHECK(folder.count() == 1);
}

TEST_CASE("what cannot be read is an input that is missing", "[file]") {
    const Folder folder;
    CHECK(errorOf([&] { readFile(folder.path / "none"); }).code == ExitCode::InputMissing);
    CHECK(errorOf([&] { readFile(folder.path); }).code == ExitCode::InputMissing);
    writeFileAtomically(folder.path / "five", "12345");
    CHECK(readFile(folder.path / "five", 5) == "12345");
    CHECK(errorOf([&] { readFile(folder.path / "five", 4); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([&] { readFile("/dev/zero", 1000); }).code == ExitCode::InvalidConfig);
}

TEST_CASE("what cannot be written says so and leaves nothing behind", "[file]") {
    const Folder folder;
    writeFileAtomically(folder.path / "file", "kept");
    const auto below = errorOf([&] { writeFileAtomically(folder.path / "file" / "below", "x"); });
    CHECK(below.code == ExitCode::CannotWrite);
    CHECK(below.message.find("Not a directory") != std::string::npos);
    const auto missing = errorOf([&] { writeFileAtomically(folder.path / "none" / "a", "x"); });
    CHECK(missing.code == ExitCode::CannotWrite);
    CHECK(missing.message.find("No such file or directory") != std::string::npos);
    CHECK(errorOf([&] { writeFileAtomically(folder.path, "x"); }).code == ExitCode::CannotWrite);
    CHECK(errorOf([&] { writeFileAtomically(folder.path / std::string(300, 'n'), "x"); }).code ==
          ExitCode::CannotWrite);
    CHECK(readFile(folder.path / "file") == "kept");
    CHECK(folder.count() == 1);
}

TEST_CASE("devices are written in place", "[file]") {
    writeFileAtomically("/dev/null", "x");
    CHECK(fs::is_character_file("/dev/null"));
    const auto full = errorOf([] { writeFileAtomically("/dev/full", "x"); });
    CHECK(full.code == ExitCode::CannotWrite);
    CHECK(full.message.find("No space left on device") != std::string::npos);
    CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("a symbolic link stays one", "[file]") {
    const Folder folder;
    fs::create_directory(folder.path / "real");
    fs::create_symlink("real/target", folder.path / "link");
    writeFileAtomically(folder.path / "link", "first");
    writeFileAtomically(folder.path / "link", "second");
    CHECK(fs::is_symlink(folder.path / "link"));
    CHECK(readFile(folder.path / "real" / "target") == "second");

    fs::create_symlink("loop", folder.path / "loop");
    CHECK(errorOf([&] { writeFileAtomically(folder.path / "loop", "x"); }).code == ExitCode::CannotWrite);
}

TEST_CASE("a name without a folder is written to the current one", "[file]") {
    const Folder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path);
    writeFileAtomically("plain", "x");
    fs::current_path(before);
    CHECK(readFile(folder.path / "plain") == "x");
    CHECK(folder.count() == 1);
}

TEST_CASE("a disk that fills up leaves the old file and no temporary one", "[file]") {
    const Folder folder;
    const fs::path path = folder.path / "a";
    writeFileAtomically(path, "old");
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    rlimit small = before;
    small.rlim_cur = 1000;
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    const auto error = errorOf([&] { writeFileAtomically(path, std::string(5000, 'x')); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    CHECK(error.code == ExitCode::CannotWrite);
    CHECK(readFile(path) == "old");
    CHECK(folder.count() == 1);
}
