#include "core/image/image_io.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/image/srgb.h"
#include "tests/support/catch.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

/// A folder of its own, removed at the end.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("ulam_image_test_" + std::to_string(::getpid()));
    Folder() {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
    std::string operator/(const std::string& name) const { return (path / name).string(); }
    std::string put(const std::string& name, std::string_view bytes) const {
        std::ofstream(path / name, std::ios::binary) << bytes;
        return *this / name;
    }
    long count() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

Image gradient(int width = 37, int height = 21) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.at(x, y) = Rgb(0.01f * float(x), 0.02f * float(y), 0.001f * float(x * y) - 0.1f);
    }
    return image;
}

struct Outcome {
    ExitCode code = ExitCode::Done;
    std::string message;
    bool mentions(std::string_view text) const { return message.find(text) != std::string::npos; }
};

template <class Action>
Outcome outcomeOf(Action action) {
    try {
        action();
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    return {};
}

/// Checked to name the file where there is an error.
Outcome reading(const std::string& path) {
    const Outcome outcome = outcomeOf([&] { readImage(path); });
    if (outcome.code != ExitCode::Done) CHECK(outcome.mentions(path));
    return outcome;
}

ExitCode codeOfReading(const std::string& path) {
    return reading(path).code;
}

template <class Write>
ExitCode codeOfWriting(Write write) {
    return outcomeOf(write).code;
}

std::string pfm(const char* magic, int width, int height, const std::vector<float>& values) {
    static_assert(std::endian::native == std::endian::little);
    std::string bytes = fmt::format("{}\n{} {}\n-1.0\n", magic, width, height);
    return bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

/// Uncompressed true-colour or grey TGA with its first row at the top.
std::string tga(int width, int height, int bytesPerPixel, const std::vector<uint8_t>& pixels) {
    const int alphaBits = bytesPerPixel == 4 ? 8 : 0;
    const uint8_t header[18] = {0,
                                0,
                                static_cast<uint8_t>(bytesPerPixel == 1 ? 3 : 2),
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                static_cast<uint8_t>(width),
                                static_cast<uint8_t>(width >> 8),
                                static_cast<uint8_t>(height),
                                static_cast<uint8_t>(height >> 8),
                                static_cast<uint8_t>(8 * bytesPerPixel),
                                static_cast<uint8_t>(0x20 | alphaBits)};
    return std::string(header, header + 18) + std::string(pixels.begin(), pixels.end());
}

}  // namespace

TEST_CASE("an exr file gives back the same floats and attributes") {
    const Folder folder;
    const Image image = gradient();
    writeExr(folder / "a.exr", image,
             {{"ulam:seed", "12345678901234567890"}, {"ulam:sampler", "mlt"}, {"scene", "a b\n\"c\""}});
    CHECK(readImage(folder / "a.exr") == image);
    const auto attributes = readImageAttributes(folder / "a.exr");
    CHECK(attributes.at("ulam:seed") == "12345678901234567890");
    CHECK(attributes.at("ulam:sampler") == "mlt");
    CHECK(attributes.at("scene") == "a b\n\"c\"");
    CHECK(folder.count() == 1);
}

TEST_CASE("a half exr file gives back the values to eleven bits") {
    const Folder folder;
    const Image image = gradient();
    writeExr(folder / "a.exr", image, {}, true);
    const Image read = readImage(folder / "a.exr");
    REQUIRE((read.width == image.width && read.height == image.height));
    bool changed = false;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            REQUIRE(read.pixels[i][c] == Approx(image.pixels[i][c]).epsilon(1.0 / 2048).margin(1e-7));
            changed = changed || read.pixels[i][c] != image.pixels[i][c];
        }
    }
    CHECK(changed);
}

TEST_CASE("the same image gives the same bytes, at another time and from several threads") {
    const Folder folder;
    const Image image = gradient(300, 200);
    const ImageAttributes attributes{{"ulam:seed", "1"}};
    writeExr(folder / "a.exr", image, attributes);
    const std::string first = readFile(folder / "a.exr");
    CHECK(first.find("capDate") == std::string::npos);
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&, i] { writeExr(folder / fmt::format("{}.exr", i), image, attributes); });
    }
    for (std::thread& thread : threads) thread.join();
    for (int i = 0; i < 4; ++i) CHECK(readFile(folder / fmt::format("{}.exr", i)) == first);
    CHECK(encodePng(image) == encodePng(image));
    CHECK(folder.count() == 5);
}

TEST_CASE("a png file shows exposed, clamped sRGB, and reads back as linear light") {
    const Folder folder;
    Image image(4, 1);
    image.pixels = {Rgb(0, 0.25f, 0.5f), Rgb(1, 4, -1), Rgb(0.001f, 0.01f, 0.1f), Rgb(0.5f)};
    writePng(folder / "a.png", image, 1);  // twice as bright
    const Image raw = readImage(folder / "a.png", Encoding::Raw), linear = readImage(folder / "a.png");
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double shown = std::clamp(2.0 * image.pixels[i][c], 0.0, 1.0);
            CHECK(raw.pixels[i][c] == Approx(std::round(255 * linearToSrgb(shown)) / 255).margin(1e-6));
            CHECK(linear.pixels[i][c] == Approx(srgbToLinear(raw.pixels[i][c])).margin(1e-6));
        }
    }
    CHECK(linear.pixels[0].y == Approx(0.5).margin(0.005));
    CHECK(folder.put("b.png", encodePng(image, 1)) == folder / "b.png");
    CHECK(readFile(folder / "b.png") == readFile(folder / "a.png"));
}

TEST_CASE("the sRGB curve goes through its published points and back") {
    CHECK(linearToSrgb(0) == 0);
    CHECK(linearToSrgb(1) == Approx(1));
    CHECK(linearToSrgb(0.0031308) == Approx(0.04045).epsilon(1e-4));
    CHECK(linearToSrgb(0.214041) == Approx(0.5).epsilon(1e-5));
    for (int i = 0; i <= 255; ++i) REQUIRE(linearToSrgb(srgbToLinear(i / 255.0)) == Approx(i / 255.0).margin(1e-7));
}

TEST_CASE("pfm and hdr files are linear and stand upright") {
    const Folder folder;
    // PFM stores the bottom row first.
    const std::string colour = folder.put("a.pfm", pfm("PF", 1, 2, {1, 2, 3, 40, 50, 60}));
    const Image image = readImage(colour);
    CHECK(image.at(0, 0) == Rgb(40, 50, 60));
    CHECK(image.at(0, 1) == Rgb(1, 2, 3));
    // Shared exponent 129: mantissa / 256 * 2.
    const std::string hdr = folder.put("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x81");
    CHECK(readImage(hdr).at(0, 0) == Rgb(1, 0.5f, 0.25f));
}

TEST_CASE("grey fills three channels and alpha is dropped without darkening the colour") {
    const Folder folder;
    CHECK(readImage(folder.put("g.pfm", pfm("Pf", 2, 1, {0.5f, 7}))).pixels == std::vector<Rgb>{Rgb(0.5f), Rgb(7)});
    const std::string opaque = folder.put("o.tga", tga(1, 1, 3, {50, 100, 200}));
    const std::string transparent = folder.put("T.TGA", tga(1, 1, 4, {50, 100, 200, 10}));
    const Image image = readImage(opaque);
    CHECK(image.at(0, 0).x == Approx(srgbToLinear(200 / 255.0)));
    CHECK(image.at(0, 0).z == Approx(srgbToLinear(50 / 255.0)));
    CHECK(readImage(transparent) == image);
    CHECK(readImage(folder.put("g.tga", tga(1, 1, 1, {200}))).at(0, 0) == Rgb(image.at(0, 0).x));
}

TEST_CASE("reading says what is wrong with a file") {
    const Folder folder;
    CHECK(codeOfReading(folder / "missing.exr") == ExitCode::InputMissing);
    CHECK(codeOfReading(folder / "no_folder/missing.exr") == ExitCode::InputMissing);
    const Outcome unknown = reading(folder.put("a.gif", "GIF89a"));
    CHECK(unknown.code == ExitCode::InvalidConfig);
    CHECK(unknown.mentions("exr, hdr, png, jpg, jpeg, tga, pfm"));
    fs::create_directory(folder / "folder.exr");
    CHECK(codeOfReading(folder / "folder.exr") == ExitCode::InvalidConfig);

    const std::string nan =
        folder.put("nan.pfm", pfm("PF", 2, 1, {0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0}));
    CHECK(reading(nan).code == ExitCode::InvalidConfig);
    CHECK(reading(nan).mentions("pixel (1, 0)"));
    CHECK(codeOfReading(folder.put("inf.pfm", pfm("Pf", 1, 1, {INFINITY}))) == ExitCode::InvalidConfig);

    std::string garbage;
    for (int i = 0; i < 600; ++i) garbage += static_cast<char>(i * i * 7 + i / 3 + 3);
    for (const char* ending : {"exr", "hdr", "png", "jpg", "tga", "pfm"}) {
        CAPTURE(ending);
        CHECK(codeOfReading(folder.put(std::string("garbage.") + ending, garbage)) == ExitCode::InvalidConfig);
        CHECK(codeOfReading(folder.put(std::string("empty.") + ending, "")) == ExitCode::InvalidConfig);
    }
    // The content decides nothing: a PNG called EXR is no EXR.
    CHECK(codeOfReading(folder.put("png.exr", encodePng(gradient()))) == ExitCode::InvalidConfig);
}

TEST_CASE("a truncated file is never read as an image") {
    const Folder folder;
    writeExr(folder / "whole.exr", gradient());
    const std::string files[][2] = {
        {"exr", readFile(folder / "whole.exr")},
        {"png", encodePng(gradient())},
        {"pfm", pfm("PF", 8, 8, std::vector<float>(192, 1))},
        {"tga", tga(8, 8, 3, std::vector<uint8_t>(192, 9))},
        {"hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + std::string(16, '\x81')},
    };
    for (const auto& [ending, bytes] : files) {
        CAPTURE(ending);
        CHECK_NOTHROW(readImage(folder.put("whole." + ending, bytes)));
        // Up to the whole of the pixels; PNG ends in a 12-byte chunk without any, and an unread checksum.
        const std::size_t end = bytes.size() - (ending == "png" ? 20 : 0);
        for (std::size_t size = 0; size < end; size += 1 + size / 7) {
            CAPTURE(size);
            REQUIRE(codeOfReading(folder.put("cut." + ending, std::string_view(bytes).substr(0, size))) ==
                    ExitCode::InvalidConfig);
        }
        CHECK(codeOfReading(folder.put("cut." + ending, std::string_view(bytes).substr(0, end - 1))) ==
              ExitCode::InvalidConfig);
    }
}

TEST_CASE("sizes are bounded before memory is taken") {
    const Folder folder;
    CHECK(codeOfReading(folder.put("a.pfm", pfm("PF", 1000000000, 1000000000, {1}))) == ExitCode::InvalidConfig);
    CHECK(codeOfReading(folder.put("b.pfm", pfm("PF", 0, 0, {}))) == ExitCode::InvalidConfig);
    CHECK(codeOfReading(folder.put("a.tga", tga(65535, 65535, 3, {1}))) == ExitCode::InvalidConfig);
    CHECK(codeOfReading(folder.put("b.tga", tga(0, 4, 3, {1}))) == ExitCode::InvalidConfig);
    CHECK(
        codeOfReading(folder.put("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n....")) ==
        ExitCode::InvalidConfig);
    // An EXR whose header is made to claim 2^31 - 1 pixels a side.
    writeExr(folder / "a.exr", gradient());
    std::string bytes = readFile(folder / "a.exr");
    const std::size_t window = bytes.find("dataWindow");
    REQUIRE(window != std::string::npos);
    const int32_t box[4] = {0, 0, 2147483646, 2147483646};
    bytes.replace(window + std::string_view("dataWindow\0box2i\0....").size(), sizeof box,
                  reinterpret_cast<const char*>(box), sizeof box);
    CHECK(codeOfReading(folder.put("b.exr", bytes)) == ExitCode::InvalidConfig);
}

TEST_CASE("a non-finite value never reaches a file") {
    const Folder folder;
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -INFINITY}) {
        Image image = gradient();
        image.at(5, 6).y = bad;
        const Outcome outcome = outcomeOf([&] { writeExr(folder / "a.exr", image); });
        CHECK(outcome.code == ExitCode::CannotWrite);
        CHECK(outcome.mentions("pixel (5, 6)"));
        CHECK(codeOfWriting([&] { writePng(folder / "a.png", image); }) == ExitCode::CannotWrite);
        CHECK(codeOfWriting([&] { encodePng(image); }) == ExitCode::CannotWrite);
    }
    Image bright(2, 2, Rgb(70000));  // infinite as half
    CHECK(codeOfWriting([&] { writeExr(folder / "a.exr", bright, {}, true); }) == ExitCode::CannotWrite);
    CHECK(folder.count() == 0);
    CHECK(codeOfWriting([&] { writeExr(folder / "a.exr", bright); }) == ExitCode::Done);
}

TEST_CASE("writing says why it cannot and leaves nothing behind") {
    const Folder folder;
    folder.put("file", "x");
    const Image image = gradient();
    const Outcome outcome = outcomeOf([&] { writeExr(folder / "file/a.exr", image); });
    CHECK(outcome.code == ExitCode::CannotWrite);
    CHECK(outcome.mentions(folder / "file/a.exr"));
    CHECK(codeOfWriting([&] { writeExr(folder / "missing/a.exr", image); }) == ExitCode::CannotWrite);
    CHECK(codeOfWriting([&] { writeExr("/dev/full", image); }) == ExitCode::CannotWrite);
    CHECK(codeOfWriting([&] { writePng("/dev/full", image); }) == ExitCode::CannotWrite);
    CHECK(codeOfWriting([&] { writeExr(folder / "empty.exr", Image()); }) == ExitCode::CannotWrite);
    CHECK(fs::is_character_file("/dev/full"));
    CHECK(folder.count() == 1);
}

TEST_CASE("channels of an exr file are told by name, other sets are refused") {
    const Folder folder;
    writeExr(folder / "a.exr", gradient());
    std::string bytes = readFile(folder / "a.exr");
    // In the channel list a name stands before its zero byte and the type (2, float).
    const std::size_t red = bytes.find(std::string("R\0\2", 3));
    REQUIRE(red != std::string::npos);
    bytes[red] = 'X';
    const Outcome outcome = reading(folder.put("b.exr", bytes));
    CHECK(outcome.code == ExitCode::InvalidConfig);
    CHECK(outcome.mentions("expected channels R, G, B"));
}
