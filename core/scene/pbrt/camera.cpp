#include "core/scene/pbrt/camera.h"

#include <fmt/format.h>

#include <cmath>

#include "core/config/suggest.h"
#include "core/scene/loading/transform.h"

namespace ulam::pbrt {
namespace {

struct FilmArea {
    int width, height;
};

FilmArea sizeOf(const Single& film) {
    const FilmArea size{film.parameters.integer("xresolution", 1280), film.parameters.integer("yresolution", 720)};
    if (size.width < 1 || size.height < 1)
        refuse(film.parameters.place(),
               fmt::format("a film has at least one pixel, not {} x {}", size.width, size.height));
    return size;
}

/// Left, right, upper and lower edge of what is rendered, in pixels.
std::array<double, 4> cropOf(const Parameters& p, const FilmArea& size) {
    std::array<double, 4> crop{0, double(size.width), 0, double(size.height)};
    const Parameter *bounds = p.find("pixelbounds", {"integer"}), *window = p.find("cropwindow", {"float"});
    const Parameter* given = window ? window : bounds;  // as in pbrt
    if (!given) return crop;
    if (given->numbers.size() != 4)
        refuse(given->place, fmt::format("{} is four numbers: x0 x1 y0 y1", inQuotes(given->name)));
    for (size_t i = 0; i < 4; ++i) {
        const double edge = i < 2 ? size.width : size.height;
        crop[i] = std::clamp(window ? std::ceil(given->numbers[i] * edge) : given->numbers[i], 0.0, edge);
    }
    if (!(crop[0] < crop[1] && crop[2] < crop[3]))
        refuse(given->place, fmt::format("{} leaves no pixels", inQuotes(given->name)));
    return crop;
}

Json readFilter(const Single& filter) {
    const Parameters& p = filter.parameters;
    const auto radius = [&](double otherwise) {
        const double x = p.number("xradius", otherwise), y = p.number("yradius", otherwise);
        if (x != y) refuse(p.place(), fmt::format("{} with different radii along x and y is not supported", p.owner()));
        return x;
    };
    Json result;
    if (filter.type == "gaussian") {
        result = {{"type", "gaussian"}, {"stddev", p.number("sigma", 0.5)}};
        radius(1.5);
    } else if (filter.type == "box") {
        result = {{"type", "box"}};
        if (radius(0.5) != 0.5) refuse(p.place(), fmt::format("{} is supported with radius 0.5 only", p.owner()));
    } else if (filter.type == "triangle") {
        result = {{"type", "tent"}, {"radius", radius(2)}};
    } else if (filter.type == "mitchell" || filter.type == "sinc") {
        // Negative in parts: a gaussian takes its place, with a warning.
        result = {{"type", filter.type == "sinc" ? "lanczos" : "mitchell"}};
        p.ignore({"xradius", "yradius", "B", "C", "tau"});
    } else {
        unknownName("pixel filter", filter.type, {"box", "gaussian", "mitchell", "sinc", "triangle"}, p.place().text());
    }
    p.finish();
    return result;
}

Json readFilm(const Single& film, const Single& filter) {
    const Parameters& p = film.parameters;
    const FilmArea size = sizeOf(film);
    // Other films than "rgb" are taken for one, with a warning.
    Json result = {
        {"type", film.type == "rgb" ? "hdrfilm" : film.type}, {"width", size.width}, {"height", size.height}};
    const auto [left, right, top, bottom] = cropOf(p, size);
    if (left > 0 || top > 0 || right < size.width || bottom < size.height) {
        result["crop_offset_x"] = int(left);
        result["crop_offset_y"] = int(top);
        result["crop_width"] = int(right - left);
        result["crop_height"] = int(bottom - top);
    }
    result["rfilter"] = readFilter(filter);
    // By default pixels hold radiance; what changes that has no effect, with a warning.
    if (const double iso = p.number("iso", 100); iso != 100) result["iso"] = iso;
    if (const double kelvin = p.number("whitebalance", 0); kelvin != 0) result["whitebalance"] = kelvin;
    if (const std::string sensor = p.text("sensor", "cie1931"); sensor != "cie1931") result["sensor"] = sensor;
    if (const double most = p.number("maxcomponentvalue", INFINITY); std::isfinite(most))
        result["maxcomponentvalue"] = most;
    p.ignore({"filename", "diagonal", "savefp16", "coordinatesystem", "nbuckets", "lambdamin", "lambdamax"});
    p.finish();
    return result;
}

/// The picture's edges on the plane at distance 1, in units of the tangent of half the angle of view.
std::array<double, 4> windowOf(const Parameters& p, const FilmArea& size) {
    const double aspect = p.number("frameaspectratio", double(size.width) / size.height);
    std::array<double, 4> window{-aspect, aspect, -1, 1};
    if (!(aspect > 1)) window = {-1, 1, -1 / aspect, 1 / aspect};
    if (const Parameter* given = p.find("screenwindow", {"float"})) {
        if (given->numbers.size() != 4) refuse(given->place, "\"screenwindow\" is four numbers: x0 x1 y0 y1");
        std::copy(given->numbers.begin(), given->numbers.end(), window.begin());
    }
    const double width = window[1] - window[0], height = window[3] - window[2];
    if (!(width > 0 && height > 0)) refuse(p.place(), "the window of the camera is empty");
    if (std::abs(width * size.height - height * size.width) > 1e-4 * width * size.height)
        refuse(p.place(), fmt::format("the window of the camera is {:g} x {:g}, the film {} x {}: pixels that are not "
                                      "square are not supported",
                                      width, height, size.width, size.height));
    return window;
}

}  // namespace

Json readSensor(const Single& camera, const Matrix4& toWorld, const Single& film, const Single& filter) {
    const Parameters& p = camera.parameters;
    if (camera.type != "perspective") unknownName("camera", camera.type, {"perspective"}, p.place().text());
    const FilmArea size = sizeOf(film);
    const double fov = p.number("fov", 90), lens = p.number("lensradius", 0), focus = p.number("focaldistance", 1e6);
    if (!(fov > 0 && fov < 180)) refuse(p.place(), "the angle of view is between 0 and 180 degrees");
    Json sensor = {{"type", lens > 0 ? "thinlens" : "perspective"}, {"fov", fov}, {"fov_axis", "smaller"}};
    const auto window = windowOf(p, size);
    const double wide = window[1] - window[0], high = window[3] - window[2];
    if (std::abs(std::min(wide, high) - 2) > 1e-6) {
        sensor["fov"] = 2 * std::atan(std::tan(fov * kPi / 360) * wide / 2) * 180 / kPi;
        sensor["fov_axis"] = "x";
    }
    if (const double x = (window[0] + window[1]) / (2 * wide); std::abs(x) > 1e-9)
        sensor["principal_point_offset_x"] = x;
    if (const double y = -(window[2] + window[3]) / (2 * high); std::abs(y) > 1e-9)
        sensor["principal_point_offset_y"] = y;
    // Here x is to the left. A camera must not scale; seen through a pinhole a scale makes no difference.
    Matrix4 mirror;
    mirror.setScale(Vec3d(-1, 1, 1));
    Matrix4 m = mirror * toWorld;
    const double scale = std::abs(uniformScale(m).value_or(1));
    for (int axis = 0; axis < 3; ++axis)
        for (int c = 0; c < 3; ++c) m[axis][c] /= scale;
    sensor["to_world"] = matrixJson(m);
    if (lens > 0) {
        sensor["aperture_radius"] = lens * scale;
        sensor["focus_distance"] = focus * scale;
    }
    const double exposure = p.number("shutterclose", 1) - p.number("shutteropen", 0);
    p.finish();
    sensor["film"] = readFilm(film, filter);
    // Nothing moves; that pbrt's pixels grow with the time has no effect, with a warning.
    if (std::abs(exposure - 1) > 1e-6) sensor["film"]["exposure_time"] = exposure;
    return sensor;
}

}  // namespace ulam::pbrt
