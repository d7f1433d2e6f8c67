#pragma once
// Scenes of the hard-scene library in tests, and what is measured of their surfaces, lights and cameras.

#include <algorithm>
#include <map>

#include "tests/experiments/scenes/generated.h"

namespace ulam {

/// A scene of the library; the Cornell box is the glossy one.
inline Json hard(const std::string& generator, Json knobs = Json::object()) {
    knobs["type"] = generator;
    if (generator == "cornell_box") knobs["variant"] = "glossy";
    return knobs;
}

inline Json dictionaryOf(const std::string& generator, const Json& knobs = Json::object()) {
    return describeGenerator(hard(generator, knobs)).dictionary();
}

inline Scene sceneOf(const std::string& generator, const Json& knobs = Json::object()) {
    return describeGenerator(hard(generator, knobs)).build();
}

inline double radians(double degrees) {
    return degrees * kPi / 180;
}

inline Vec3d vectorOf(const Json& json) {
    return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

/// Green's, of a light.
inline double radianceOf(const Json& shape) {
    const Json& radiance = shape["emitter"]["radiance"];
    return radiance.is_array() ? radiance[1].get<double>() : radiance.get<double>();
}

/// Corners and triangles as a dictionary's `mesh` has them.
struct Surface {
    std::vector<Vec3d> corners;
    std::vector<std::array<size_t, 3>> triangles;

    explicit Surface(const Json& mesh) {
        const Json &p = mesh["positions"], &t = mesh["triangles"];
        for (size_t i = 0; i < p.size(); i += 3)
            corners.emplace_back(p[i].get<double>(), p[i + 1].get<double>(), p[i + 2].get<double>());
        for (size_t i = 0; i < t.size(); i += 3)
            triangles.push_back({t[i].get<size_t>(), t[i + 1].get<size_t>(), t[i + 2].get<size_t>()});
    }

    Vec3d lower() const {
        Vec3d result = corners[0];
        for (const Vec3d& c : corners)
            for (int k = 0; k < 3; ++k) result[k] = std::min(result[k], c[k]);
        return result;
    }
    Vec3d upper() const {
        Vec3d result = corners[0];
        for (const Vec3d& c : corners)
            for (int k = 0; k < 3; ++k) result[k] = std::max(result[k], c[k]);
        return result;
    }
    /// Of length twice the area.
    Vec3d normal(size_t triangle) const {
        const auto& [i, j, k] = triangles[triangle];
        return (corners[j] - corners[i]).cross(corners[k] - corners[i]);
    }
    double area() const {
        double sum = 0;
        for (size_t i = 0; i < triangles.size(); ++i) sum += normal(i).length() / 2;
        return sum;
    }
    /// By the divergence theorem: positive where a closed surface's normals point outwards.
    double volume() const {
        double sum = 0;
        for (const auto& [i, j, k] : triangles) sum += corners[i].dot(corners[j].cross(corners[k])) / 6;
        return sum;
    }
    /// Edges that triangles do not pass as often in one direction as in the other; once each, but where boxes of a mesh
    /// touch along an edge.
    std::vector<std::pair<size_t, size_t>> boundary() const {
        std::map<std::pair<size_t, size_t>, int> passes;
        for (const auto& t : triangles)
            for (size_t k = 0; k < 3; ++k) {
                const size_t from = t[k], to = t[(k + 1) % 3];
                passes[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
            }
        std::vector<std::pair<size_t, size_t>> result;
        for (const auto& [edge, difference] : passes)
            if (difference != 0) result.push_back(edge);
        return result;
    }
};

/// A closed surface that looks outwards and holds this volume.
inline void checkClosed(const Surface& surface, double volume) {
    CHECK(surface.boundary().empty());
    CHECK(surface.volume() == Approx(volume).epsilon(1e-9));
}

inline void checkBox(const Surface& surface, const Vec3d& lower, const Vec3d& upper) {
    for (int k = 0; k < 3; ++k) {
        CHECK(surface.lower()[k] == Approx(lower[k]).margin(1e-9));
        CHECK(surface.upper()[k] == Approx(upper[k]).margin(1e-9));
    }
}

/// Vertex normals that agree with the triangles they stand at.
inline void checkNormals(const Json& mesh) {
    const Surface surface(mesh);
    const Json& n = mesh["normals"];
    REQUIRE(n.size() == 3 * surface.corners.size());
    for (size_t t = 0; t < surface.triangles.size(); ++t)
        for (const size_t corner : surface.triangles[t])
            REQUIRE(surface.normal(t).dot({n[3 * corner].get<double>(), n[3 * corner + 1].get<double>(),
                                           n[3 * corner + 2].get<double>()}) > 0);
}

/// ∬ of a profile's polygon turned into an n-gon: a body of revolution of `sides` sides has this share of the volume of
/// the round one with the same polygon as profile.
inline double roundness(int sides) {
    return sides * std::sin(2 * kPi / sides) / (2 * kPi);
}

/// Where the camera stands, the middle of its image, and the angle that the image's width (or height) spans.
inline void checkCamera(const Scene& scene, const Vec3d& origin, const Vec3d& target, double fov, bool alongWidth = true) {
    const Vec3f eye = scene.sensor->samplePosition({}).position;
    CHECK(length(eye - Vec3f(origin)) < 1e-4f);
    const float w = float(scene.sensor->width()), h = float(scene.sensor->height());
    const auto direction = [&](float x, float y) {
        return scene.sensor->direction(scene.sensor->samplePosition({}), {x, y});
    };
    const Vec3f ahead = direction(w / 2, h / 2);
    CHECK(dot(ahead, normalize(Vec3f(target - origin))) == Approx(1).epsilon(1e-5));
    const Vec3f side = alongWidth ? direction(0, h / 2) : direction(w / 2, 0);
    CHECK(std::acos(double(dot(ahead, side))) == Approx(radians(fov / 2)).epsilon(1e-4));
}

/// A disc seen from `target` under an angle (degrees), whose irradiance there is given.
inline void checkDiscLight(const Scene& scene, const Vec3d& center, const Vec3d& target, double width, double irradiance) {
    const Shape& light = scene.shapes[shapeNamed(scene, "light")];
    const Disk& disk = std::get<Disk>(light.geometry);
    CHECK(length(disk.center - Vec3f(center)) < 1e-5 * center.length());
    CHECK(dot(disk.normal, normalize(Vec3f(target - center))) == Approx(1).epsilon(1e-6));
    const double half = std::atan(double(length(disk.axisX)) / (target - center).length());
    CHECK(half == Approx(radians(width / 2)).epsilon(1e-5));
    CHECK(length(disk.axisX) == Approx(length(disk.axisY)));
    // E = π L sin² of the disc's half angle (Lambert 1760).
    CHECK(kPi * std::get<AreaEmitter>(scene.emitters[light.emitter]).emitted.x * std::pow(std::sin(half), 2) ==
          Approx(irradiance).epsilon(1e-5));
}

inline double emittedPower(const Scene& scene, const std::string& name) {
    const Shape& light = scene.shapes[shapeNamed(scene, name)];
    return kPi * light.area * luminance(std::get<AreaEmitter>(scene.emitters[light.emitter]).emitted);
}

}  // namespace ulam
