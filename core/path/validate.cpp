#include "core/path/validate.h"

#include <fmt/format.h>

#include "core/path/local_bsdf.h"
#include "core/path/reference_factors.h"

namespace ulam {
namespace {

using Kind = Vertex::Kind;
using Finding = std::optional<std::string>;

std::string text(const Vec3d& v) {
    return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z);
}
std::string text(const Vec3f& v) {
    return text(inDouble(v));
}

const char* name(Kind kind) {
    constexpr const char* kNames[] = {"on a surface", "on the lens", "a point without surface", "at infinity", "a direction of parallel light"};
    return kNames[int(kind)];
}
const char* name(Lobe lobe) {
    constexpr const char* kNames[] = {"smooth", "delta reflection", "delta transmission", "null"};
    return kNames[int(lobe)];
}

class Validator {
public:
    Validator(Tracing& tracing, const PathLimits& limits, const Path& path, const PathFactors& factors)
        : tracing_(tracing),
          scene_(tracing.scene()),
          limits_(limits),
          path_(path),
          factors_(factors),
          k_(path.length()) {}

    Finding run() {
        if (auto wrong = size()) return wrong;
        for (int i = 0; i <= k_; ++i)
            if (auto wrong = vertex(i)) return fmt::format("x_{} of x_0 … x_{}: {}", i, k_, *wrong);
        for (int i = 0; i < k_; ++i)
            if (auto wrong = edge(i)) return fmt::format("edge x_{} – x_{} of x_0 … x_{}: {}", i, i + 1, k_, *wrong);
        for (int i = 0; i <= k_; ++i)
            if (auto wrong = scattering(i)) return fmt::format("x_{} of x_0 … x_{}: {}", i, k_, *wrong);
        return contribution();
    }

private:
    Finding size() const {
        if (path_.size() < 2 || path_.size() > kMaxVertices)
            return fmt::format("{} vertices, expected 2 to {}", path_.size(), kMaxVertices);
        if (k_ > limits_.maxDepth) return fmt::format("{} edges, more than max_depth = {}", k_, limits_.maxDepth);
        if (factors_.size != path_.size())
            return fmt::format("factors of {} vertices beside a path of {}", factors_.size, path_.size());
        return {};
    }

    // Vertices: kind, place, normals.

    Finding vertex(int i) const {
        const Vertex& v = path_[i];
        if ((i == 0 || i == k_) && isDelta(v.lobe)) return fmt::format("an end of the path with lobe {}", name(v.lobe));
        if (i == k_) return lens(v);
        if (i > 0 && !v.onSurface()) return fmt::format("{}, expected a surface", name(v.kind));
        if (v.onSurface()) {
            if (auto wrong = surface(v)) return wrong;
        }
        return i == 0 ? light(v) : std::nullopt;
    }

    Finding lens(const Vertex& v) const {
        const Perspective& sensor = *scene_.sensor;
        const Kind expected = sensor.positionIsDelta() ? Kind::Point : Kind::Lens;
        if (v.kind != expected || v.shape != kNone) return fmt::format("{}, expected the camera, {}", name(v.kind), name(expected));
        const Vec3d off = inDouble(v.position) - inDouble(sensor.position());
        if (expected == Kind::Point && off.length() > 0)
            return fmt::format("at {}, but the pinhole is at {}", text(v.position), text(sensor.position()));
        if (off.length() > sensor.apertureRadius() + tracing_.offsetLength() || std::abs(off.dot(inDouble(sensor.axis()))) > tracing_.offsetLength())
            return fmt::format("at {}, but the aperture of radius {} is around {}", text(v.position), sensor.apertureRadius(), text(sensor.position()));
        if (expected == Kind::Lens && v.normal != sensor.axis()) return fmt::format("normal {} on the lens, expected {}", text(v.normal), text(sensor.axis()));
        return {};
    }

    Finding light(const Vertex& v) const {
        const uint32_t e = scene_.emitterAt(v);
        if (e >= scene_.emitters.size()) return fmt::format("{} that belongs to no emitter", name(v.kind));
        const Emitter& emitter = scene_.emitters[e];
        const auto* given = dispatch(emitter, []<class E>(const E& concrete) -> const DeltaPosition* {
            if constexpr (std::is_base_of_v<DeltaPosition, E>) return &concrete;
            else return nullptr;
        });
        if (given && v.position != given->position)
            return fmt::format("{} at {}, but its emitter is {} at {}", name(v.kind), text(v.position), name(given->kind), text(given->position));
        const Kind expected = given ? given->kind : isEnvironment(emitter) ? Kind::Infinite : Kind::Surface;
        if (v.kind != expected) return fmt::format("{}, but its emitter is {}", name(v.kind), name(expected));
        if (v.atInfinity() && std::abs(length(v.position) - 1) > kCosineError)
            return fmt::format("direction {} of length {}, expected 1", text(v.position), length(v.position));
        return {};
    }

    Finding surface(const Vertex& v) const {
        if (v.shape >= scene_.shapes.size())
            return fmt::format("shape {}, but the scene has {}", v.shape, scene_.shapes.size());
        const Shape& shape = scene_.shapes[v.shape];
        Vec3d place(0), normal(0), shading(0);
        if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
            const Vec3d center = inDouble(sphere->center), outward = (inDouble(v.position) - center).normalized();
            place = center + outward * double(sphere->radius);
            normal = shading = shape.flipNormals ? -outward : outward;
        } else if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
            if (v.uv.length() > 1 + 1e-5f) return fmt::format("({}, {}) is outside the unit disc", v.uv.x, v.uv.y);
            const Vec3d x = inDouble(disk->axisX), y = inDouble(disk->axisY), n = x.cross(y).normalized();
            place = inDouble(disk->center) + x * double(v.uv.x) + y * double(v.uv.y);
            normal = shading = n.dot(inDouble(disk->normal)) > 0 ? n : -n;
        } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
            const Vec3d axis = inDouble(cylinder->axes[2]), from = inDouble(v.position) - inDouble(cylinder->base);
            const double height = std::clamp(from.dot(axis), 0.0, double(cylinder->length));
            const Vec3d outward = (from - axis * from.dot(axis)).normalized();
            place = inDouble(cylinder->base) + axis * height + outward * double(cylinder->radius);
            normal = shading = shape.flipNormals ? -outward : outward;
        } else {
            const Mesh& mesh = *shape.triangleMesh();
            const auto* instance = std::get_if<MeshInstance>(&shape.geometry);
            if (v.primitive >= mesh.triangles.size())
                return fmt::format("triangle {} of {}", v.primitive, mesh.triangles.size());
            const auto& t = mesh.triangles[v.primitive];
            const double b[3] = {1 - double(v.uv.x) - v.uv.y, v.uv.x, v.uv.y};
            if (!(std::min({b[0], b[1], b[2]}) > -1e-5))
                return fmt::format("barycentric coordinates ({}, {}) outside the triangle", v.uv.x, v.uv.y);
            Vec3d interpolated(0), corners[3];
            for (size_t j = 0; j < 3; ++j) {
                corners[j] = inDouble(mesh.positions[t[j]]);
                if (instance) corners[j] = transformed(*instance, corners[j]);
                place += corners[j] * b[j];
                if (!mesh.normals.empty()) interpolated += inDouble(mesh.normals[t[j]]) * b[j];
            }
            normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
            // Where opposite normals cancel out their direction is rounding.
            const bool cancels = interpolated.length() < 1e-3;
            if (instance) {
                const Matrix4 m = matrixOf(*instance);
                if (m.determinant() < 0) normal = -normal;
                m.inverse().transposed().multDirMatrix(Vec3d(interpolated), interpolated);
            }
            shading = mesh.normals.empty() || interpolated.length() == 0 ? normal
                      : cancels                                          ? inDouble(v.shadingNormal)
                                                                         : interpolated.normalized();
        }
        const double off = (place - inDouble(v.position)).length();
        if (!(off <= tracing_.offsetLength()))
            return fmt::format("at {}, but its place on shape \"{}\" is {}: {:.3g} apart", text(v.position), shape.id,
                               text(place), off);
        if (!((normal - inDouble(v.normal)).length() <= 2e-6))
            return fmt::format("normal {}, recomputed {}", text(v.normal), text(normal));
        if (!((shading - inDouble(v.shadingNormal)).length() <= 1e-5))
            return fmt::format("shading normal {}, recomputed {}", text(v.shadingNormal), text(shading));
        return {};
    }

    static Matrix4 matrixOf(const MeshInstance& instance) {
        Matrix4 m;
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 3; ++column) m[row][column] = instance.toWorld[size_t(row)][column];
        return m;
    }
    static Vec3d transformed(const MeshInstance& instance, const Vec3d& p) {
        Vec3d out;
        matrixOf(instance).multVecMatrix(p, out);
        return out;
    }

    // Edges: visibility, geometry.

    Finding edge(int i) const {
        const Vertex &a = path_[i], &b = path_[i + 1];
        const Edge& e = factors_.edge[i];
        const Vec3d w = exactDirection(a, b);
        if (!((inDouble(e.direction) - w).length() <= kCosineError))
            return fmt::format("direction {}, recomputed {}", text(e.direction), text(w));
        if (auto wrong = differs("cosine at the light's side", e.cosA, cosineRange(exactCosine(a, w)))) return wrong;
        if (auto wrong = differs("cosine at the camera's side", e.cosB, cosineRange(exactCosine(b, w)))) return wrong;
        const double inverseD2 = exactInverseD2(a, b);
        if (auto wrong = differs("1 / squared length", e.inverseD2, {inverseD2, inverseD2})) return wrong;
        if (!visible(a, b))
            return fmt::format("something stands between {} and {}", text(a.position), text(b.position));
        return {};
    }

    /// A connection's visibility test or a walk's ray from either side: which of them made the edge the path does not
    /// say, and where an edge of some object is met within rounding they differ.
    bool visible(const Vertex& a, const Vertex& b) const {
        if (tracing_.visible(a, b) || arrives(b, a) || (!a.atInfinity() && arrives(a, b))) return true;
        // An edge that grazes something is free when it is displaced by what positions may be off.
        const Frame frame(directionTo(a, b));
        const auto displaced = [](Vertex v, const Vec3f& by) {
            if (!v.atInfinity()) v.position += by;
            return v;
        };
        for (const Vec3f& side : {frame.s, -frame.s, frame.t, -frame.t}) {
            const Vec3f by = side * tracing_.offsetLength();
            if (tracing_.visible(displaced(a, by), displaced(b, by))) return true;
        }
        return false;
    }
    bool arrives(const Vertex& from, const Vertex& to) const {
        // From where a walk's ray starts, so that the ray is the walk's up to the rounding of the vertex's place.
        Vec3f w = directionTo(from, to);
        const Vec3f origin = tracing_.rayOrigin(from, w);
        if (!to.atInfinity()) w = normalize(to.position - origin);
        Vertex hit;
        if (!tracing_.nextFrom(origin, w, hit)) return !hittable(to);
        if (to.atInfinity() || !hit.onSurface()) return hit.kind == to.kind || (!hittable(to) && !hit.onSurface());
        const double d = (inDouble(to.position) - inDouble(origin)).length();
        const double free = (inDouble(hit.position) - inDouble(origin)).length();
        const double grazing = std::max(1e-3, exactCosine(to, exactDirection(from, to)));
        return free >= d - 4 * tracing_.offsetLength() / grazing;
    }

    // Scattering at vertices, and the densities that follow.

    Finding scattering(int i) const {
        const Vertex& v = path_[i];
        const Vec3d toLight = i > 0 ? exactDirection(v, path_[i - 1]) : Vec3d(0),
                    toCamera = i < k_ ? exactDirection(v, path_[i + 1]) : Vec3d(0);
        FactorRanges expected;
        if (i == 0) {
            expected = emissionReference(scene_, v, toCamera);
            if (!(brightest(expected) > 0)) return fmt::format("no light leaves along {}", text(toCamera));
        } else if (i == k_) {
            // By the edge's own direction, which has passed: at the window's border the last bit decides.
            const auto response = scene_.sensor->respond(v, -factors_.edge[k_ - 1].direction);
            if (!(response.importance > 0)) return fmt::format("direction {} misses the sensor's window", text(toLight));
            const Vec2f& raster = response.raster;
            const Vec3f back = scene_.sensor->direction(v, raster);
            if (!((inDouble(back) - toLight).length() <= 1e-5))
                return fmt::format("direction {} has raster ({}, {}), whose direction is {}", text(toLight), raster.x,
                                   raster.y, text(back));
            expected = importanceReference(scene_, v, toLight);
        } else {
            if (auto wrong = lobe(i, toLight, toCamera)) return wrong;
            expected = scatteringReference(scene_, v, toLight, toCamera);
            if (!(brightest(expected) > 0))
                return fmt::format("shape \"{}\" scatters nothing by its lobe {} from {} to {}",
                                   scene_.shapes[v.shape].id, name(v.lobe), text(toLight), text(toCamera));
        }
        const Scattering& at = factors_.at[i];
        const char* names[5] = {"red f", "green f", "blue f", "density towards the camera",
                                "density towards the light"};
        const double stored[5] = {at.f.x, at.f.y, at.f.z, at.pdfToCamera, at.pdfToLight};
        for (size_t j = 0; j < 5; ++j)
            if (auto wrong = differs(names[j], stored[j], expected[j])) return wrong;
        return areaDensities(i, expected, toLight, toCamera);
    }

    Finding lobe(int i, const Vec3d& toLight, const Vec3d& toCamera) const {
        const Vertex& v = path_[i];
        const auto [smooth, delta] = withBsdf(scene_, v, float(inDouble(v.shadingNormal).dot(toLight)), [](const auto& bsdf, const LocalFrame&) {
            return std::pair(bsdf.hasSmooth, bsdf.hasDelta);
        });
        if (!(isDelta(v.lobe) ? delta : smooth))
            return fmt::format("shape \"{}\" has no lobe {}", scene_.shapes[v.shape].id, name(v.lobe));
        // Rays start an offset away from their vertex, so that the direction found from positions is off by offset /
        // length.
        const double inverse[2] = {exactInverseD2(v, path_[i - 1]), exactInverseD2(v, path_[i + 1])};
        double tolerance = 4e-6;
        for (int side = 0; side < 2; ++side)
            if (!path_[i - 1 + 2 * side].atInfinity())
                tolerance += 2 * tracing_.offsetLength() * std::sqrt(inverse[side]);
        double ior = 1;
        forEachBsdf(scene_.materialAt(v).front, [&ior](const Bsdf& bsdf) {
            if (const auto* glass = std::get_if<Dielectric>(&bsdf)) ior = std::max(ior, glass->ior);
        });
        tolerance *= ior;
        const double error = deltaLawError(scene_, v, toLight, toCamera);
        if (error <= tolerance) return {};
        return fmt::format("{} between {} and {} misses its law by {:.3g}, more than {:.3g}", name(v.lobe),
                           text(toLight), text(toCamera), error, tolerance);
    }

    /// Densities of the neighbours per area, as seen from x_i: directional density × |cosθ| there / squared length.
    Finding areaDensities(int i, const FactorRanges& expected, const Vec3d& toLight, const Vec3d& toCamera) const {
        const auto perArea = [](Range pdf, double cosine, double inverseD2) {
            const Range c = cosineRange(cosine);
            return Range{pdf.low * c.low * inverseD2, pdf.high * c.high * inverseD2};
        };
        const Vertex& v = path_[i];
        if (i < k_) {
            const Vertex& next = path_[i + 1];
            const Range range = perArea(expected[3], exactCosine(next, toCamera), exactInverseD2(v, next));
            if (auto wrong = differs("area density of its successor from the light", factors_.fromLight(i + 1), range))
                return wrong;
        }
        if (i > 0) {
            const Vertex& previous = path_[i - 1];
            const Range range = perArea(expected[4], exactCosine(previous, toLight), exactInverseD2(v, previous));
            if (auto wrong =
                    differs("area density of its predecessor from the camera", factors_.fromCamera(i - 1), range))
                return wrong;
        }
        return {};
    }

    /// The product of the factors, whose parts are right.
    Finding contribution() const {
        Spectrum f(1.0);
        for (int i = 0; i <= k_; ++i) f *= factors_.at[i].f;
        for (int i = 0; i < k_; ++i) f *= factors_.edge[i].cosA * factors_.edge[i].cosB * factors_.edge[i].inverseD2;
        const Spectrum stored = factors_.contribution();
        for (int c = 0; c < 3; ++c)
            if (auto wrong = differs("f", stored[c], {f[c], f[c]})) return wrong;
        return {};
    }

    static Range cosineRange(double cosine) { return {std::max(0.0, cosine - kCosineError), cosine + kCosineError}; }
    static double brightest(const FactorRanges& r) { return std::max({r[0].high, r[1].high, r[2].high}); }

    static Finding differs(const char* what, double stored, const Range& expected) {
        // Below the smallest normal number a relative tolerance means nothing. Also caught: not a number.
        constexpr double kSmallest = std::numeric_limits<double>::min();
        if (stored >= expected.low * (1 - kFactorTolerance) - kSmallest &&
            stored <= expected.high * (1 + kFactorTolerance) + kSmallest)
            return {};
        return fmt::format("{} is {:.9g}, recomputed {:.9g} … {:.9g} (relative tolerance {})", what, stored,
                           expected.low, expected.high, kFactorTolerance);
    }

    Tracing& tracing_;
    const Scene& scene_;
    const PathLimits& limits_;
    const Path& path_;
    const PathFactors& factors_;
    int k_;
};

}  // namespace

std::optional<std::string> validate(Tracing& tracing, const PathLimits& limits, const Path& path,
                                    const PathFactors& factors) {
    return Validator(tracing, limits, path, factors).run();
}

}  // namespace ulam
