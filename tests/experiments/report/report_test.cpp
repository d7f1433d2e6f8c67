#include "experiments/report/report.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "core/base/error.h"
#include "core/base/file.h"
#include "experiments/report/picture_code.h"
#include "tests/experiments/report/fake_run.h"
#include "tests/support/catch.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

/// An empty folder, gone at the end. With ULAM_REPORT_DIR the folder of that name is used and kept.
class RunFolder {
public:
    explicit RunFolder(const char* keep = nullptr) : kept_(keep != nullptr) {
        path = kept_ ? fs::path(keep)
                     : fs::temp_directory_path() / ("ulam_report_test_" + std::to_string(std::random_device{}()));
        fs::create_directories(path);
    }
    ~RunFolder() {
        if (!kept_) fs::remove_all(path);
    }
    fs::path path;

private:
    bool kept_;
};

Rgb decodePixel(const std::string& bytes, std::size_t i) {
    uint32_t word = 0;
    for (int k = 3; k >= 0; --k) word = word << 8 | static_cast<uint8_t>(bytes[4 * i + std::size_t(k)]);
    const float unit = std::ldexp(1.0f, int(word >> 27) - 24);
    return Rgb(float(word & 511), float(word >> 9 & 511), float(word >> 18 & 511)) * unit;
}

std::size_t countOf(const std::string& text, const std::string& word) {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++n;
    return n;
}

}  // namespace

TEST_CASE("RGB9E5 keeps the largest channel to one part in 512 over its whole range") {
    std::mt19937 random(7);
    Image image(1000, 1);
    for (Rgb& pixel : image.pixels) {
        const float scale = std::exp2(float(random() % 2800) / 100 - 13);
        pixel = Rgb(scale, scale * float(random() % 1000) / 1000, scale * float(random() % 1000) / 1000);
    }
    const std::string bytes = encodeRgb9e5(image);
    REQUIRE(bytes.size() == 4000);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const Rgb decoded = decodePixel(bytes, i), original = image.pixels[i];
        for (int c = 0; c < 3; ++c) CHECK(std::abs(decoded[c] - original[c]) <= original.x / 510);
    }
}

TEST_CASE("RGB9E5 at its edges") {
    Image image(5, 1);
    image.pixels = {Rgb(0), Rgb(-3, 1, 0), Rgb(1e9f), Rgb(1023.9f, 0, 0), Rgb(1e-12f)};
    const std::string bytes = encodeRgb9e5(image);
    CHECK(decodePixel(bytes, 0) == Rgb(0));
    CHECK(decodePixel(bytes, 1) == Rgb(0, 1, 0));
    CHECK(decodePixel(bytes, 2) == Rgb(65408));
    CHECK(decodePixel(bytes, 3) == Rgb(1024, 0, 0));  // the mantissa rounds up to 512
    CHECK(decodePixel(bytes, 4) == Rgb(0));
}

TEST_CASE("base64 as in RFC 4648, section 10") {
    CHECK(encodeBase64("") == "");
    CHECK(encodeBase64("f") == "Zg==");
    CHECK(encodeBase64("fo") == "Zm8=");
    CHECK(encodeBase64("foo") == "Zm9v");
    CHECK(encodeBase64("foobar") == "Zm9vYmFy");
    CHECK(encodeBase64("\xff\xef\xbe") == "/+++");
}

TEST_CASE("shrinking averages whole blocks and what is left at the edges") {
    Image image(3, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) image.at(x, y) = Rgb(float(x + 10 * y));
    const Image small = shrink(image, 2);
    REQUIRE(small.width == 2);
    REQUIRE(small.height == 1);
    CHECK(small.at(0, 0).x == Approx(5.5));
    CHECK(small.at(1, 0).x == Approx(7));
    CHECK(shrink(image, 1) == image);
}

TEST_CASE("a report holds its run and asks for nothing") {
    RunFolder folder(std::getenv("ULAM_REPORT_DIR"));
    tests::FakeRun(folder.path, 128, 8, 8).write();
    writeReport(folder.path);
    const std::string page = readFile(folder.path / "report.html");

    CHECK(page.size() < 5'000'000);
    // 2 references, per cell the mean, the median and the worst replicate and two maps, and of two cells five techniques, of
    // the others their chains and two more maps.
    CHECK(countOf(page, "<script type=\"text/plain\"") == 2 + 6 * 5 + 2 * 5 * 2 + 4 * 3);
    for (const char* address : {"src=\"", "@import", "url(http", "<link rel=\"stylesheet", "fetch(", "XMLHttpRequest"})
        CHECK(countOf(page, address) == 0);
    // Text from files cannot end the element it stands in: every script element is one of ours.
    CHECK(countOf(page, "</script") == 1 + 64 + 1);
    CHECK(countOf(page, "@SCRIPT@") == 0);
    CHECK(page.find("normalisation refined by large steps") != page.npos);
    CHECK(page.find("<title>backlit_grid_of_holes · Ulam</title>") != page.npos);
}

TEST_CASE("the mean over replicates is embedded, not a replicate") {
    RunFolder folder;
    for (int r = 0; r < 2; ++r) {
        const fs::path replicate = folder.path / "cells/a" / ("r00" + std::to_string(r));
        fs::create_directories(replicate);
        writeExr((replicate / "image.exr").string(), Image(2, 2, Rgb(r == 0 ? 1.0f : 3.0f)));
    }
    writeFileAtomically(folder.path / "summary.json",
                        R"({"cells": [{"cell": "a", "scene": "s", "sampler": "x", "replicates": 2}]})");
    writeReport(folder.path);
    const std::string page = readFile(folder.path / "report.html");
    CHECK(page.find(">" + encodeBase64(encodeRgb9e5(Image(2, 2, Rgb(2)))) + "<") != page.npos);
}

TEST_CASE("without the first replicate the others stand for the cell by their numbers") {
    RunFolder folder;
    for (int r = 1; r < 4; ++r) {
        const fs::path replicate = folder.path / "cells/a" / ("r00" + std::to_string(r));
        fs::create_directories(replicate);
        writeExr((replicate / "image.exr").string(), Image(2, 2, Rgb(float(r))));
        writeFileAtomically(replicate / "result.json",
                            R"({"replicate": )" + std::to_string(r) + R"(, "bias_ledger": ["clamped"]})");
    }
    writeFileAtomically(folder.path / "summary.json",
                        R"({"cells": [{"cell": "a", "scene": "s", "sampler": "x", "replicate_numbers": [1, 2, 3],
                            "metrics": {"relmse": {"values": [0.3, 0.1, 0.2]}}}]})");
    writeReport(folder.path);
    const std::string page = readFile(folder.path / "report.html");
    CHECK(page.find(R"("results":{"a":{"replicate":1,"bias_ledger":["clamped"]}})") != page.npos);
    CHECK(page.find(R"("median_replicate":3)") != page.npos);
    CHECK(page.find(R"("worst_replicate":1)") != page.npos);
}

TEST_CASE("images of techniques are read by their names, in pairs and small") {
    RunFolder folder;
    const fs::path extra = folder.path / "cells/a/r000/extra";
    fs::create_directories(extra);
    writeExr((extra.parent_path() / "image.exr").string(), Image(300, 300, Rgb(1)));
    for (const char* name : {"s10_t02_weighted", "s10_t02_unweighted", "s00_t03_weighted", "s0x_t03_weighted", "s_weighted",
                             "samples_weighted", "s01_t", "albedo"})
        writeExr((extra / (std::string(name) + ".exr")).string(), Image(300, 300, Rgb(0.5f)));
    writeFileAtomically(folder.path / "summary.json", R"({"cells": [{"cell": "a", "scene": "s", "sampler": "x"}]})");
    writeReport(folder.path);
    const std::string page = readFile(folder.path / "report.html");
    CHECK(page.find(R"("techniques":[{"s":10,"t":2,"weighted":)") != page.npos);
    CHECK(countOf(page, R"("unweighted":)") == 1);  // of the second there is no other half
    CHECK(countOf(page, R"({"width":100,"height":100})") == 2);
}

namespace {

/// The page of cells with one replicate each.
std::string pageOf(const std::vector<Image>& images) {
    RunFolder folder;
    Json cells = Json::array();
    for (const Image& image : images) {
        const std::string cell = "c" + std::to_string(cells.size());
        fs::create_directories(folder.path / "cells" / cell / "r000");
        writeExr((folder.path / "cells" / cell / "r000/image.exr").string(), image);
        cells.push_back({{"cell", cell}, {"scene", "s"}, {"sampler", "x"}});
    }
    writeReport(folder.path, {{"cells", cells}});
    return readFile(folder.path / "report.html");
}

/// Brightness over 2^24, colours, and noise of the given logarithmic standard deviation.
Image noisyRamp(int width, int height, double sigma) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(-sigma * sigma / 2, sigma);
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = Rgb(1, 0.5f, 0.25f) * float(std::exp2(12.0 * x / width - 9) * std::exp(normal(random)));
    return image;
}

Image decodeJpeg(const JpegPicture& picture) {
    RunFolder folder;
    const std::string file = (folder.path / "picture.jpg").string();
    writeFileAtomically(file, picture.bytes);
    Image image = readImage(file, Encoding::Raw);
    for (Rgb& pixel : image.pixels)
        for (int c = 0; c < 3; ++c) pixel[c] = float(picture.toe * std::sinh(picture.step * 255 * pixel[c]));
    return image;
}

double meanOf(const Image& image) {
    double total = 0;
    for (const Rgb& pixel : image.pixels) total += luminance(Spectrum(pixel));
    return total / double(image.pixels.size());
}

/// Root of the mean square over pixels of (luminance of a − of b) / b; where b is dark, of the toe.
double relativeDifference(const Image& a, const Image& b) {
    const double toe = 8.0 / 64;
    double total = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double x = luminance(Spectrum(a.pixels[i])), y = luminance(Spectrum(b.pixels[i]));
        total += (x - y) * (x - y) / (y * y + toe * toe) / double(a.pixels.size());
    }
    return std::sqrt(total);
}

}  // namespace

TEST_CASE("a JPEG picture keeps values, and the amount of noise") {
    const Image smooth = noisyRamp(256, 128, 0);
    CHECK(relativeDifference(decodeJpeg(encodeJpegPicture(smooth, 90)), smooth) < 0.03);
    const Image noisy = noisyRamp(256, 128, 0.5), decoded = decodeJpeg(encodeJpegPicture(noisy, 90));
    CHECK(meanOf(decoded) == Approx(meanOf(noisy)).epsilon(0.02));
    const double noise = relativeDifference(noisy, smooth);
    CHECK(relativeDifference(decoded, noisy) < 0.25 * noise);
    CHECK(relativeDifference(decoded, smooth) == Approx(noise).epsilon(0.05));
    CHECK(relativeDifference(decodeJpeg(encodeJpegPicture(noisy, 100)), noisy) <
          0.5 * relativeDifference(decoded, noisy));
}

TEST_CASE("a JPEG picture at its edges") {
    CHECK(decodeJpeg(encodeJpegPicture(Image(16, 16), 90)) == Image(16, 16));
    CHECK(decodeJpeg(encodeJpegPicture(Image(16, 16, Rgb(-1)), 90)) == Image(16, 16));
    Image firefly(64, 64, Rgb(1));
    firefly.at(32, 32) = Rgb(1e6f);
    const Image decoded = decodeJpeg(encodeJpegPicture(firefly, 90));
    CHECK(decoded.at(0, 0).x == Approx(1).epsilon(0.03));
    CHECK(decoded.at(32, 32).x == Approx(256).epsilon(0.3));
}

TEST_CASE("images too large for one page become JPEG, and shrink where that is not enough") {
    const std::string exact = pageOf({Image(700, 600, Rgb(1))});
    CHECK(exact.find(R"("shrink":1,"exact":true)") != exact.npos);
    const std::string jpeg = pageOf({Image(1800, 1500, Rgb(1))});
    CHECK(jpeg.find(R"("width":1800,"height":1500,"toe":)") != jpeg.npos);
    CHECK(jpeg.find(R"("shrink":1,"exact":false)") != jpeg.npos);
    std::mt19937 random(5);
    Image noise(3200, 2000);
    for (Rgb& pixel : noise.pixels)
        for (int c = 0; c < 3; ++c) pixel[c] = std::ldexp(1.0f, int(random() % 8));
    const std::string small = pageOf({noise});
    CHECK(small.find(R"("width":1600,"height":1000,"toe":)") != small.npos);
    CHECK(small.find(R"("shrink":2,"exact":false)") != small.npos);
    CHECK(double(small.size()) < kReportBytes);
    CHECK(double(small.size()) > kReportBytes / 3);  // what is left is room for maps, which a single replicate has not
}

TEST_CASE("what pictures leave of the room improves the JPEG") {
    // At the quality that is enough, each of these takes a small part of the page; as RGB9E5 all are too large.
    const Image noise = noisyRamp(640, 480, 0.5);
    const std::string page = pageOf(std::vector<Image>(8, noise));
    CHECK(page.find(R"("shrink":1,"exact":false)") != page.npos);
    const auto holds = [&](int quality) {
        return page.find(">" + encodeBase64(encodeJpegPicture(noise, quality).bytes) + "<") != page.npos;
    };
    CHECK(holds(100));
    CHECK_FALSE(holds(90));
    CHECK(double(page.size()) < kReportBytes);
}

TEST_CASE("cells may have films of their own") {
    const std::string page = pageOf({Image(8, 8, Rgb(1)), Image(1800, 1500, Rgb(1))});
    CHECK(page.find(R"("width":1800,"height":1500,"toe":)") != page.npos);
    CHECK(double(page.size()) < kReportBytes);
}

TEST_CASE("a summary may be larger than what is read of users") {
    RunFolder folder;
    std::ofstream(folder.path / "summary.json") << R"({"cells": []})" << std::string(kMaxJsonBytes, ' ');
    writeReport(folder.path);
    CHECK(fs::exists(folder.path / "report.html"));
}

TEST_CASE("a report needs a summary and nothing else") {
    RunFolder folder;
    try {
        writeReport(folder.path);
        FAIL("no error without summary.json");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::InputMissing);
    }
    writeFileAtomically(folder.path / "summary.json", R"({"cells": []})");
    writeReport(folder.path);
    CHECK(fs::file_size(folder.path / "report.html") > 50000);  // style and script alone are larger

    writeFileAtomically(folder.path / "summary.json", R"({"cells": [{"cell": 3}]})");
    try {
        writeReport(folder.path);
        FAIL("no error for a damaged summary");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::InvalidConfig);
        CHECK(std::string(error.what()).find("summary.json") != std::string::npos);
    }
}
