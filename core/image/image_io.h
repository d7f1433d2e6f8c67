#pragma once
// Image files: the only place that knows OpenImageIO.

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/image/image.h"

namespace ulam {

/// What the numbers of a file mean. By its format: float and half files (exr, hdr, pfm) are linear, integer files
/// (png, jpg, tga) are sRGB and become linear. Raw: the numbers as stored, integers divided by their largest value;
/// for roughness maps and the like.
enum class Encoding { ByFormat, Raw };

/// The largest image that is read, in pixels: 16384 x 8192.
inline constexpr long long kMaxImagePixels = 1LL << 27;

/// Reads exr, hdr, png, jpg (jpeg), tga or pfm, told apart by the ending of the name. One channel is grey and fills all
/// three; alpha is dropped without multiplying by it; of an EXR with more channels R, G and B are taken, and its data
/// window is the image.
/// Throws ExitCode::InputMissing if there is no such file, and ExitCode::InvalidConfig, with the file and the reason,
/// if it is of another format, damaged, empty, larger than kMaxImagePixels, or holds NaN or infinity.
Image readImage(const std::string& path, Encoding encoding = Encoding::ByFormat);

using ImageAttributes = std::vector<std::pair<std::string, std::string>>;

/// Writes channels R, G, B as float (or half), losslessly compressed, with string attributes and nothing that depends
/// on time, machine or number of threads: the same image and attributes give the same bytes. Attribute names are taken
/// as they are; a name with a prefix of its own ("ulam:seed") meets no meaning that EXR gives to names. Atomic and
/// checked, as writeFileAtomically. Throws ExitCode::CannotWrite also where a value is NaN, infinite, or too large for
/// half: a non-finite value never reaches a file.
void writeExr(const std::string& path, const Image& image, const ImageAttributes& attributes = {}, bool half = false);

/// All string attributes of an image file by name. Errors as readImage.
std::map<std::string, std::string> readImageAttributes(const std::string& path);

/// The bytes of an 8-bit sRGB PNG: values times 2^exposure, clamped to [0, 1]. Throws as writeExr.
std::string encodePng(const Image& image, double exposure = 0);
/// The same, written atomically.
void writePng(const std::string& path, const Image& image, double exposure = 0);

/// The bytes of a JPEG of 8-bit numbers as they are: R, G, B of each pixel, row by row from the top. Quality from 1 to
/// 100; colours have the resolution of the picture.
std::string encodeJpeg(const std::vector<std::uint8_t>& rgb, int width, int height, int quality);

}  // namespace ulam
