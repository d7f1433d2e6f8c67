#include "core/image/packed_image.h"

#include <bit>

#include "core/base/random.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

/// Pixels of values drawn from `count` different ones.
Image pictureOf(int count, bool grey) {
    Image image(700, 300);
    Random random(makeKey(9), 0, 0);
    const auto value = [&] { return std::ldexp(float(random.index(count)) + 0.25f, -7); };
    for (Rgb& p : image.pixels) {
        p = {value(), value(), value()};
        if (grey) p = Rgb(p.x);
    }
    return image;
}

bool sameBits(const Rgb& a, const Rgb& b) {
    for (int c = 0; c < 3; ++c)
        if (std::bit_cast<uint32_t>(a[c]) != std::bit_cast<uint32_t>(b[c])) return false;
    return true;
}

}  // namespace

TEST_CASE("packed images: every pixel comes back bit for bit, in as few bytes as the values allow") {
    struct Case {
        int values;
        size_t bytesEach;
    };
    for (const Case& c : {Case{2, 1}, {256, 1}, {257, 2}, {65536, 2}, {200'000, 4}})
        for (const bool grey : {false, true}) {
            INFO(c.values << (grey ? " greys" : " values"));
            Image image = pictureOf(c.values, grey);
            const PackedImage packed(image);
            CHECK(packed.bytes() == image.pixels.size() * c.bytesEach * (grey ? 1 : 3));
            bool same = packed.width() == image.width && packed.height() == image.height;
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x) same = same && sameBits(packed.at(x, y), image.at(x, y));
            CHECK(same);
        }
}

TEST_CASE("packed images: zeros keep their sign, one pixel that is not grey is enough for colours") {
    Image image(3, 1, Rgb(0.5f));
    image.at(1, 0) = Rgb(0.0f, -0.0f, 0.0f);
    const PackedImage packed(image);
    CHECK(packed.bytes() == 9);
    CHECK(sameBits(packed.at(1, 0), image.at(1, 0)));
}
