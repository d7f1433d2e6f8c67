#include "core/scene/loading/sensors.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

/// Perspective with what only the loader needs.
struct PerspectiveParameters : Perspective::Parameters {
    std::string focalLength = "50mm";
    JsonNode toWorld;
    template <class V>
    void describe(V& v) {
        Perspective::Parameters::describe(v);
        v("focal_length", focalLength, {.help = "on 35 mm film, its diagonal seen in full: a number followed by mm"});
        v("to_world", toWorld,
          {.help = "camera to world, without scale: a matrix or a list of steps",
           .example = R"([{"type": "lookat", "origin": [0, 1, 4], "target": [0, 1, 0], "up": [0, 1, 0]}])"});
    }
};

struct ThinLensParameters : PerspectiveParameters {
    double apertureRadius = 0, focusDistance = 0;
    template <class V>
    void describe(V& v) {
        PerspectiveParameters::describe(v);
        v("aperture_radius", apertureRadius, {.help = "radius of the lens, in scene units", .min = 0});
        v("focus_distance", focusDistance, {.help = "distance along the view at which the image is sharp", .min = 0});
    }
};

constexpr int kMostPixels = 1 << 26;  // a film has hundreds of bytes a pixel

struct FilmParameters {
    static constexpr int kLargest = 16384;

    int width = 768, height = 576, cropOffsetX = 0, cropOffsetY = 0, cropWidth = 0, cropHeight = 0;
    JsonNode rfilter{Json{{"type", "gaussian"}}};
    template <class V>
    void describe(V& v) {
        v("width", width, {.help = "width", .unit = "pixels", .min = 1, .max = kLargest});
        v("height", height, {.help = "height", .unit = "pixels", .min = 1, .max = kLargest});
        v("crop_offset_x", cropOffsetX,
          {.help = "left edge of the part that is rendered", .unit = "pixels", .min = 0, .max = kLargest});
        v("crop_offset_y", cropOffsetY,
          {.help = "upper edge of the part that is rendered", .unit = "pixels", .min = 0, .max = kLargest});
        v("crop_width", cropWidth,
          {.help = "width of that part; 0: up to the right edge", .unit = "pixels", .min = 0, .max = kLargest});
        v("crop_height", cropHeight,
          {.help = "height of that part; 0: up to the lower edge", .unit = "pixels", .min = 0, .max = kLargest});
        v("rfilter", rfilter, {.help = "reconstruction filter"});
    }
};

/// Degrees along the diagonal of a frame of 36 mm × 24 mm behind a lens of this focal length, such as "50mm".
double diagonalFov(const std::string& focalLength, const JsonNode& place) {
    std::string_view digits = focalLength;
    if (digits.ends_with("mm")) digits.remove_suffix(2);
    double length = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), length);
    if (error != std::errc() || end != digits.data() + digits.size() || !(length > 0 && length < 1e6))
        place.expected("a focal length in millimetres, such as \"50mm\"");
    return 2 * std::atan(std::hypot(36, 24) / (2 * length)) * 180 / kPi;
}

template <class P>
ReconstructionFilter readFilterOf(const JsonNode& node) {
    return ReconstructionFilter(parsePlugin<P>(node));
}

const PluginTable<ReconstructionFilter(const JsonNode&)>& filterTable() {
    static const PluginTable<ReconstructionFilter(const JsonNode&)> plugins(
        "reconstruction filter",
        {
            {{"box", "the pixel's square", parameterInfo<ReconstructionFilter::BoxParameters>()},
             readFilterOf<ReconstructionFilter::BoxParameters>},
            {{"gaussian", "Gaussian bell, cut off", parameterInfo<ReconstructionFilter::GaussianParameters>()},
             readFilterOf<ReconstructionFilter::GaussianParameters>},
            {{"tent", "linear fall-off", parameterInfo<ReconstructionFilter::TentParameters>()},
             readFilterOf<ReconstructionFilter::TentParameters>},
        });
    return plugins;
}

ReconstructionFilter readFilter(const JsonNode& node, LoadContext& context) {
    if (std::ranges::find(replacedFilters(), pluginName(node)) == replacedFilters().end()) return filterTable().find(node).read(node);
    context.warnings.push_back(fmt::format("a gaussian takes the place of the reconstruction filter {}, which is negative in parts, at {}",
                                           inQuotes(pluginName(node)), node.where()));
    return ReconstructionFilter(ReconstructionFilter::GaussianParameters{});
}

/// Options that mean nothing here (file formats and the like) are noted.
std::vector<std::string> noteUnknownOptions(const JsonNode& film, const ParameterList& known, LoadContext& context) {
    std::vector<std::string> names, keys;
    for (const auto& parameter : known.parameters()) names.push_back(parameter.name);
    for (const auto& [key, value] : film.members()) {
        if (std::find(names.begin(), names.end(), key) != names.end()) continue;
        keys.push_back(key);
        if (key == "type" || key == "id") continue;
        const std::string hint = didYouMean(key, names);
        context.warnings.push_back(fmt::format("film option {} has no effect, at {}{}{}", inQuotes(key), value.where(),
                                               hint.empty() ? "" : "; ", hint));
    }
    return keys;
}

void readInto(FilmParameters& parameters, const JsonNode& film, LoadContext& context) {
    if (isPlugin(film) && pluginName(film) != "hdrfilm")
        context.warnings.push_back(fmt::format("the film {} is taken for an hdrfilm, at {}", inQuotes(pluginName(film)), film.where()));
    ParameterList list;
    parameters.describe(list);
    list.parse(film, noteUnknownOptions(film, list, context));
}

int croppedLength(int size, int offset, int length, const char* axis, const JsonNode& place) {
    const int rest = size - offset;
    if (rest <= 0 || length > rest)
        place.fail(fmt::format(
            "the crop reaches beyond the film: crop_offset_{0} {1} and crop_{2} {3} do not fit into {2} {4}", axis,
            offset, *axis == 'x' ? "width" : "height", length, size));
    return length > 0 ? length : rest;
}

}  // namespace

std::vector<PluginInfo> sensorPlugins() {
    return {{"perspective", "pinhole camera", parameterInfo<PerspectiveParameters>()},
            {"thinlens", "camera with an aperture and depth of field", parameterInfo<ThinLensParameters>()}};
}
std::vector<PluginInfo> filmPlugins() {
    return {{"hdrfilm", "size of the image and reconstruction filter", parameterInfo<FilmParameters>()}};
}
std::vector<PluginInfo> filterPlugins() {
    return filterTable().infos();
}

const std::vector<std::string>& replacedFilters() {
    // Samples are drawn from the filter here, so it cannot be negative anywhere.
    static const std::vector<std::string> negative{"catmullrom", "lanczos", "mitchell"};
    return negative;
}

bool noteIfUnused(const JsonNode& node, LoadContext& context) {
    static constexpr std::array kNames{
        "aov",         "depth",     "direct",      "emission_reparam", "moment",     "path",   "prb",  "prb_basic",
        "ptracer",     "stokes",    "volpath",     "volpathmis",       "bdpt",       "pssmlt", "mlt",  "photonmapper",
        "independent", "ldsampler", "multijitter", "orthogonal",       "stratified", "halton", "sobol"};
    const std::string& name = pluginName(node);
    const std::string key = node.key();
    if (key != "integrator" && key != "sampler" && key != "accelerator" && std::find(kNames.begin(), kNames.end(), name) == kNames.end())
        return false;
    context.warnings.push_back(fmt::format("{} has no effect, at {}", inQuotes(name), node.where()));
    return true;
}

FilmSettings readFilm(const JsonNode& sensor, const JsonNode& replacement, LoadContext& context) {
    FilmParameters p;
    bool found = false;
    for (const JsonNode& nested : nestedPlugins(sensor, parameterInfo<ThinLensParameters>())) {
        if (noteIfUnused(nested, context)) continue;
        if (std::exchange(found, true)) nested.fail("a sensor has one film");
        readInto(p, nested, context);
    }
    const JsonNode& last = replacement.isNull() ? sensor : replacement;
    if (!replacement.isNull()) readInto(p, replacement, context);
    if (double(p.width) * p.height > kMostPixels)
        last.fail(fmt::format("a film of {} x {} pixels has more than {}", p.width, p.height, kMostPixels));
    FilmSettings film;
    film.size = {p.width,
                 p.height,
                 p.cropOffsetX,
                 p.cropOffsetY,
                 croppedLength(p.width, p.cropOffsetX, p.cropWidth, "x", last),
                 croppedLength(p.height, p.cropOffsetY, p.cropHeight, "y", last)};
    film.filter = readFilter(p.rfilter, context);
    return film;
}

Perspective readSensor(const JsonNode& node, const FilmSettings& film, LoadContext&) {
    ThinLensParameters p;
    Perspective::Aperture aperture;
    if (pluginName(node) == "perspective") {
        static_cast<PerspectiveParameters&>(p) = parsePlugin<PerspectiveParameters>(node);
    } else if (pluginName(node) == "thinlens") {
        p = parsePlugin<ThinLensParameters>(node);
        const JsonNode radius = node.at("aperture_radius"), distance = node.at("focus_distance");
        if (!(p.apertureRadius > 0)) radius.expected("a radius above 0", "a camera without aperture is a perspective");
        if (!(p.focusDistance > 0)) distance.expected("a distance above 0");
        aperture = {p.apertureRadius, p.focusDistance};
    } else {
        unknownPlugin(node, "sensor", sensorPlugins());
    }
    const auto focalLength = node.find("focal_length");
    if (p.fov > 0 && focalLength) focalLength->fail("a sensor has fov or focal_length, not both");
    if (p.fov == 0) {
        p.fov = diagonalFov(p.focalLength, focalLength ? *focalLength : node);
        p.fovAxis = "diagonal";
    }
    const Matrix4 toWorld = parseTransform(p.toWorld);
    const auto scale = uniformScale(toWorld);
    if (!scale || std::abs(std::abs(*scale) - 1) > 1e-3) p.toWorld.fail("a camera's to_world must not scale or shear");
    // The filters of the outermost pixels reach this far beyond the image.
    const float margin = std::max(0.0f, film.filter.radius() - 0.5f);
    return Perspective(p, aperture, toWorld, film.size, margin);
}

}  // namespace ulam
