#include "experiments/scenes/receiver_view.h"

namespace ulam {
namespace {

constexpr int kFilmSize = 256;

/// From raster coordinates of the full film (y down, x to the left of the world's +x) to the receiver's plane.
Imath::V2d onReceiver(double pinholeX, const FilmSize& film, double x, double y) {
    // "smaller": the shorter side of the film spans the unit square.
    const double pixel = 1.0 / std::min(film.width, film.height);
    return {pinholeX + pixel * (film.width * (0.5 - pinholeX) - x), pixel * (film.height * 0.5 - y)};
}

}  // namespace

Json ReceiverView::sensor() const {
    const double fov = 2 * std::atan(0.5 / (distance - kPinholeZ)) * 180 / kPi;
    return {
        {"type", "perspective"},
        {"fov", fov},
        {"fov_axis", "smaller"},
        // The image's middle is the receiver's, also where the pinhole stands aside.
        {"principal_point_offset_x", pinholeX},
        {"to_world", Json::array({{{"type", "lookat"},
                                   {"origin", {pinholeX, 0.0, kPinholeZ}},
                                   {"target", {pinholeX, 0.0, distance}},
                                   {"up", {0, 1, 0}}}})},
        {"film", {{"type", "hdrfilm"}, {"width", kFilmSize}, {"height", kFilmSize}, {"rfilter", {{"type", "box"}}}}}};
}

ReceiverView::Square ReceiverView::pixel(const FilmSize& film, int x, int y) const {
    const double column = film.cropOffsetX + x, row = film.cropOffsetY + y;
    const Imath::V2d a = onReceiver(pinholeX, film, column, row), b = onReceiver(pinholeX, film, column + 1, row + 1);
    return {b.x, a.x, b.y, a.y};
}

ReceiverView::Square ReceiverView::image(const FilmSize& film) const {
    const Square first = pixel(film, 0, 0), last = pixel(film, film.cropWidth - 1, film.cropHeight - 1);
    return {last.x0, first.x1, last.y0, first.y1};
}

}  // namespace ulam
