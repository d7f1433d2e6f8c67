#pragma once
// HDR pictures as text inside a web page.

#include <string>
#include <string_view>

#include "core/image/image.h"

namespace ulam {

/// RGB9E5, 4 bytes a pixel, little-endian, rows from the top: three 9-bit mantissas under one 5-bit exponent, value =
/// mantissa · 2^(exponent − 24). Negative values become 0, values above 65408 become 65408; relative to the largest
/// channel of a pixel the error is at most 2^-9. (OpenGL extension EXT_texture_shared_exponent, section 3.8.x.)
std::string encodeRgb9e5(const Image& image);

/// A picture as JPEG: a channel of code c, from 0 to 255, has the value toe · sinh(step · c), which is linear in the
/// dark and exponential in the light.
struct JpegPicture {
    std::string bytes;
    double toe = 1, step = 0;
};

/// Codes are a few per cent apart; a JPEG of quality 90 (of 100) adds some more where noise is strong, and leaves its
/// amount as it is. Noisy renders then take some 2 to 6 bits a pixel, RGB9E5 32. Values beyond 256 times the 99th
/// percentile of the pixels' largest channels become that.
JpegPicture encodeJpegPicture(const Image& image, int quality);

/// RFC 4648, section 4, with padding.
std::string encodeBase64(std::string_view bytes);

/// Every pixel the mean of a block of factor × factor, of what there is of it at the right and lower edges.
Image shrink(const Image& image, int factor);

}  // namespace ulam
