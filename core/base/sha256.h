#pragma once
// SHA-256 (NIST FIPS 180-4), to tell whether two files or scenes are the same.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace ulam {

/// Takes bytes piece by piece; `digest` ends the message and may be called once.
class Sha256 {
public:
    void update(std::string_view bytes);
    std::array<uint8_t, 32> digest();

private:
    void compress(const uint8_t* block);

    // The first 32 bits of the fractional parts of the square roots of the first 8 primes (FIPS 180-4, 5.3.3).
    std::array<uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                   0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<uint8_t, 64> buffer_{};
    uint64_t length_ = 0;  // bytes so far
};

/// 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);
/// The first 64 bits, for streams of random numbers that a text names.
uint64_t hash64(std::string_view text);
/// Of a file's content. Throws ExitCode::InputMissing where it cannot be read.
std::string sha256OfFile(const std::string& path);

}  // namespace ulam
