#include "core/base/sha256.h"

#include <filesystem>

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("sha256 agrees with the examples of NIST") {
    CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(sha256(std::string(1000000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("sha256 does not depend on how the bytes are cut") {
    std::string bytes;
    for (int i = 0; i < 300; ++i) bytes += static_cast<char>(7 * i);
    // 55, 56, 63 and 64 are where the padding changes its shape.
    for (const std::size_t size : {1, 55, 56, 57, 63, 64, 65, 119, 120, 128, 300}) {
        Sha256 whole, cut;
        whole.update(std::string_view(bytes).substr(0, size));
        for (std::size_t i = 0; i < size; ++i) cut.update(std::string_view(bytes).substr(i, 1));
        CHECK(whole.digest() == cut.digest());
    }
}

TEST_CASE("sha256 of a file is that of its bytes") {
    const std::string path = (std::filesystem::temp_directory_path() / "ulam_sha256_test.bin").string();
    writeFileAtomically(path, std::string("a\0b\n", 4));
    CHECK(sha256OfFile(path) == sha256(std::string("a\0b\n", 4)));
    std::filesystem::remove(path);
    CHECK_THROWS_AS(sha256OfFile(path), Error);
}
