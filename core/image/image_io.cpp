#include "core/image/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/image/srgb.h"

namespace ulam {
namespace {

constexpr std::array<std::string_view, 7> kFormats{"exr", "hdr", "png", "jpg", "jpeg", "tga", "pfm"};
constexpr float kMaxHalf = 65504;

/// Once: no chatter, no threads of its own (callers have theirs), one reader per file, limits checked before
/// allocation.
void configureLibrary() {
    static const bool done = [] {
        OIIO::attribute("debug", 0);
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
        OIIO::attribute("try_all_readers", 0);
        OIIO::attribute("limits:channels", 64);
        OIIO::attribute("limits:imagesize_MB", static_cast<int>(kMaxImagePixels * 4 * sizeof(float) >> 20));
        return true;
    }();
    (void)done;
}

std::string oneLine(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text.empty() ? "no reason given" : text;
}

std::string endingOf(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    if (!ending.empty()) ending.erase(0, 1);
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

/// The reader of a file, and the bytes that it reads where it can read from memory: then what cannot be read is told from
/// what is damaged.
struct ImageFile {
    std::unique_ptr<const std::string> bytes;
    std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
    std::unique_ptr<OIIO::ImageInput> input;
};

ImageFile openImage(const std::string& path) {
    configureLibrary();
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) fail(ExitCode::InputMissing, "{}: no such image file", path);
    const std::string ending = endingOf(path);
    if (std::find(kFormats.begin(), kFormats.end(), ending) == kFormats.end()) {
        fail(ExitCode::InvalidConfig, "{}: expected an image file ending in {}; found \"{}\"", path,
             fmt::join(kFormats, ", "), ending);
    }
    if (!std::filesystem::is_regular_file(path, ignored)) {
        fail(ExitCode::InvalidConfig, "{}: expected an image file; found something that is no file", path);
    }

    ImageFile file;
    file.input = OIIO::ImageInput::create(ending);
    const auto& input = file.input;
    if (!input) fail(ExitCode::InvalidConfig, "{}: {}", path, oneLine(OIIO::geterror()));
    if (input->supports("ioproxy")) {
        file.bytes = std::make_unique<const std::string>(readFile(path));
        file.memory = std::make_unique<OIIO::Filesystem::IOMemReader>(file.bytes->data(), file.bytes->size());
        input->set_ioproxy(file.memory.get());
    } else {
        requireReadable(path);
    }
    OIIO::ImageSpec hints, spec;
    hints["oiio:UnassociatedAlpha"] = 1;  // colours must not be multiplied by an alpha that is dropped
    if (!input->open(path, spec, hints)) {
        fail(ExitCode::InvalidConfig, "{}: no readable {} image: {}", path, ending, oneLine(input->geterror()));
    }
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep) {
        fail(ExitCode::InvalidConfig, "{}: expected a flat image; found {} x {} x {} pixels of {} {}channels", path,
             spec.width, spec.height, spec.depth, spec.nchannels, spec.deep ? "deep " : "");
    }
    if (static_cast<long long>(spec.width) * spec.height > kMaxImagePixels) {
        fail(ExitCode::InvalidConfig, "{}: {} x {} pixels are more than the limit of {}", path, spec.width, spec.height,
             kMaxImagePixels);
    }
    // As it is read, and packed, say, while that is still there.
    requireMemoryToRead(path, {fmt::format("a picture of {} x {} pixels", spec.width, spec.height),
                               2.0 * spec.width * spec.height * sizeof(Rgb), "a smaller picture"});
    return file;
}

/// The channels to read, [first, first + count): R, G, B side by side, or one grey one.
struct Channels {
    int first;
    int count;
};

Channels chooseChannels(const std::string& path, const OIIO::ImageSpec& spec) {
    const auto& names = spec.channelnames;
    const auto red = std::find(names.begin(), names.end(), "R");
    if (names.end() - red >= 3 && red[1] == "G" && red[2] == "B") return {static_cast<int>(red - names.begin()), 3};
    if (names.size() == 1 || (names.size() == 2 && names[1] == "A")) return {0, 1};
    fail(ExitCode::InvalidConfig, "{}: expected channels R, G, B, or one grey channel; found {}", path,
         fmt::join(names, ", "));
}

void requireFinite(const std::string& path, const Image& image, ExitCode code, float limit) {
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Rgb& p = image.at(x, y);
            for (const float v : {p.x, p.y, p.z}) {
                if (!(std::abs(v) <= limit)) {
                    fail(code, "{}: expected finite values no larger than {}; found ({}, {}, {}) in pixel ({}, {})",
                         path, limit, p.x, p.y, p.z, x, y);
                }
            }
        }
    }
}

/// The image holds integers of 1 or 2 bytes divided by the largest: few enough values for a table.
void decodeSrgb(Image& image, std::size_t bytesPerValue) {
    std::vector<float> table(bytesPerValue == 1 ? 256 : 65536);
    const auto largest = static_cast<float>(table.size() - 1);
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(srgbToLinear(static_cast<float>(i) / largest));
    for (Rgb& p : image.pixels) {
        for (float* v : {&p.x, &p.y, &p.z}) *v = table[static_cast<std::size_t>(*v * largest + 0.5f)];
    }
}

/// The bytes of a file of the format, made in memory, so that writing them is under our control.
std::string encode(const char* format, const std::string& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                   const void* pixels) {
    configureLibrary();
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create(format, &bytes);
    if (!output || !output->open(path, spec) || !output->write_image(type, pixels) || !output->close()) {
        fail(ExitCode::CannotWrite, "cannot write {}: {}", path,
             oneLine(output ? output->geterror() : OIIO::geterror()));
    }
    return {reinterpret_cast<const char*>(bytes.buffer().data()), bytes.buffer().size()};
}

void requirePixels(const std::string& path, const Image& image, float limit) {
    if (image.width < 1 || image.height < 1 ||
        image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
        fail(ExitCode::CannotWrite, "cannot write {}: an image of {} x {} with {} pixels", path, image.width,
             image.height, image.pixels.size());
    }
    requireFinite(path, image, ExitCode::CannotWrite, limit);
}

std::string encodePng(const std::string& path, const Image& image, double exposure) {
    requirePixels(path, image, std::numeric_limits<float>::max());
    const double scale = std::exp2(exposure);
    std::vector<uint8_t> encoded;
    encoded.reserve(image.pixels.size() * 3);
    for (const Rgb& p : image.pixels) {
        for (const float v : {p.x, p.y, p.z}) {
            encoded.push_back(static_cast<uint8_t>(linearToSrgb(std::clamp(v * scale, 0.0, 1.0)) * 255 + 0.5));
        }
    }
    OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
    return encode("png", path, spec, OIIO::TypeDesc::UINT8, encoded.data());
}

}  // namespace

Image readImage(const std::string& path, Encoding encoding) {
    const ImageFile file = openImage(path);
    const auto& input = file.input;
    const OIIO::ImageSpec spec = input->spec();
    const Channels channels = chooseChannels(path, spec);

    Image image(spec.width, spec.height);
    const bool read = input->read_image(0, 0, channels.first, channels.first + channels.count, OIIO::TypeDesc::FLOAT,
                                        image.pixels.data(), sizeof(Rgb));
    // Some readers only complain about data that end too early.
    if (!read || input->has_error()) {
        fail(ExitCode::InvalidConfig, "{}: the image is damaged: {}", path, oneLine(input->geterror()));
    }
    if (channels.count == 1) {
        for (Rgb& p : image.pixels) p = Rgb(p.x);
    }
    if (encoding == Encoding::ByFormat && !spec.format.is_floating_point()) decodeSrgb(image, spec.format.size());
    requireFinite(path, image, ExitCode::InvalidConfig, std::numeric_limits<float>::max());
    return image;
}

void writeExr(const std::string& path, const Image& image, const ImageAttributes& attributes, bool half) {
    requirePixels(path, image, half ? kMaxHalf : std::numeric_limits<float>::max());
    OIIO::ImageSpec spec(image.width, image.height, 3, half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    for (const auto& [name, value] : attributes) spec[name] = value;
    spec["compression"] = "rle";  // of noise zip saves 1 % more, for five times the time; black pixels take next to nothing in both
    spec["DateTime"] = 0;  // else the library writes the time of day; a number is not written
    writeFileAtomically(path, encode("exr", path, spec, OIIO::TypeDesc::FLOAT, image.pixels.data()));
}

std::map<std::string, std::string> readImageAttributes(const std::string& path) {
    std::map<std::string, std::string> attributes;
    const ImageFile file = openImage(path);
    for (const OIIO::ParamValue& value : file.input->spec().extra_attribs) {
        if (value.type() == OIIO::TypeDesc::STRING) attributes[value.name().string()] = value.get_string();
    }
    return attributes;
}

std::string encodePng(const Image& image, double exposure) {
    return encodePng("a PNG in memory", image, exposure);
}

void writePng(const std::string& path, const Image& image, double exposure) {
    writeFileAtomically(path, encodePng(path, image, exposure));
}

std::string encodeJpeg(const std::vector<std::uint8_t>& rgb, int width, int height, int quality) {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("Compression", fmt::format("jpeg:{}", quality));
    spec.attribute("jpeg:subsampling", "4:4:4");
    return encode("jpg", "a JPEG in memory", spec, OIIO::TypeDesc::UINT8, rgb.data());
}

}  // namespace ulam
