#include "core/scene/ray_tracer.h"

#include "core/base/error.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <xmmintrin.h>

#include <limits>
#include <map>
#include <optional>
#include <set>

namespace ulam {
namespace {

// Embree 4 dropped the context argument.
#if RTC_VERSION_MAJOR >= 4
void intersect1(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, nullptr); }
void occluded1(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }
#else
void intersect1(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
}
void occluded1(RTCScene scene, RTCRay& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
}
#endif

void set(RTCRay& ray, const Vec3f& o, const Vec3f& d, float tfar) {
    ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
    ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
    ray.tnear = 0, ray.tfar = tfar, ray.time = 0;
    ray.mask = ~0u, ray.id = 0, ray.flags = 0;
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Shapes that Embree does not know, in double: their own coordinates may be far from the world's origin.

struct Crossing {
    double distance;
    Vec2f uv{0, 0};
};

std::optional<Crossing> meet(const Disk& disk, const Vec3d& o, const Vec3d& d, double near, double far) {
    const Vec3d x(disk.axisX), y(disk.axisY), n = x.cross(y), from = Vec3d(disk.center) - o;
    const double t = n.dot(from) / n.dot(d);
    if (!(t > near && t < far)) return std::nullopt;
    const Vec3d p = d * t - from;
    const double n2 = n.dot(n), u = p.cross(y).dot(n) / n2, v = x.cross(p).dot(n) / n2;
    if (u * u + v * v > 1) return std::nullopt;
    return Crossing{t, {float(u), float(v)}};
}

std::optional<Crossing> meet(const Cylinder& cylinder, const Vec3d& o, const Vec3d& d, double near, double far) {
    const Vec3d from = o - Vec3d(cylinder.base), axis(cylinder.axes[2]);
    const double height = from.dot(axis), climb = d.dot(axis);
    const Vec3d p = from - axis * height, q = d - axis * climb;  // across the axis
    const double a = q.dot(q), b = p.dot(q), c = p.dot(p) - double(cylinder.radius) * cylinder.radius;
    const double discriminant = b * b - a * c;
    if (!(a > 0 && discriminant >= 0)) return std::nullopt;
    const double s = -b - std::copysign(std::sqrt(discriminant), b);  // the root without cancellation
    const double first = s / a, second = c / s;
    for (const double t : {std::min(first, second), std::max(first, second)}) {
        const double z = height + climb * t;
        if (t > near && t < far && z >= 0 && z <= cylinder.length) return Crossing{t};
    }
    return std::nullopt;
}

template <class G>
std::optional<Crossing> meet(const void* shape, const RTCRay& ray) {
    return meet(std::get<G>(static_cast<const Shape*>(shape)->geometry), Vec3d(ray.org_x, ray.org_y, ray.org_z), Vec3d(ray.dir_x, ray.dir_y, ray.dir_z),
                 ray.tnear, ray.tfar);
}

// Embree's callbacks; single rays only are cast here, so N = 1.

template <class G>
void intersectUser(const RTCIntersectFunctionNArguments* args) {
    if (!args->valid[0]) return;
    RTCRayHit& ray = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const auto crossing = meet<G>(args->geometryUserPtr, ray.ray);
    if (!crossing) return;
    ray.ray.tfar = float(crossing->distance);
    ray.hit.geomID = args->geomID;
    ray.hit.primID = args->primID;
    ray.hit.instID[0] = args->context->instID[0];
    ray.hit.u = crossing->uv.x, ray.hit.v = crossing->uv.y;
}

template <class G>
void occludedUser(const RTCOccludedFunctionNArguments* args) {
    if (!args->valid[0]) return;
    RTCRay& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (meet<G>(args->geometryUserPtr, ray)) ray.tfar = -kInfinity;
}

void boundsOfShape(const RTCBoundsFunctionArguments* args) {
    const Imath::Box3f box = static_cast<const Shape*>(args->geometryUserPtr)->bounds();
    RTCBounds& b = *args->bounds_o;
    // Rounded outwards: hits are found in double.
    const float slack = 1e-5f * (std::max({length(box.min), length(box.max)}) + length(box.size()));
    b.lower_x = box.min.x - slack, b.lower_y = box.min.y - slack, b.lower_z = box.min.z - slack;
    b.upper_x = box.max.x + slack, b.upper_y = box.max.y + slack, b.upper_z = box.max.z + slack;
}

}  // namespace

struct RayTracer::Embree {
    // One thread builds, so that the tree is the same every time.
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = nullptr;
    std::vector<std::unique_ptr<const Shape>> userShapes;  ///< what the callbacks look at
    std::map<const Mesh*, RTCScene> groups;                ///< by the first mesh of a shape group

    ~Embree() {
        if (scene) rtcReleaseScene(scene);
        for (const auto& group : groups) rtcReleaseScene(group.second);
        rtcReleaseDevice(device);
    }

    /// The ray tracer reads the mesh's own arrays, which must stay.
    RTCGeometry triangles(const Mesh& mesh) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0, sizeof(Vec3f), mesh.positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0, sizeof(mesh.triangles[0]), mesh.triangles.size());
        return geometry;
    }

    RTCGeometry sphere(const Sphere& sphere) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        auto* p = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
        p[0] = sphere.center.x, p[1] = sphere.center.y, p[2] = sphere.center.z, p[3] = sphere.radius;
        return geometry;
    }

    /// The instance that these shapes begin with. A group is built when its first instance comes.
    RTCGeometry instance(std::span<const Shape> shapes) {
        const auto& first = std::get<MeshInstance>(shapes[0].geometry);
        const auto [group, isNew] = groups.try_emplace(first.mesh.get());
        if (isNew) {
            group->second = rtcNewScene(device);
            for (uint32_t member = 0; member < shapes.size(); ++member) {
                const auto* next = std::get_if<MeshInstance>(&shapes[member].geometry);
                if (!next || next->member != member) break;
                attach(group->second, triangles(*next->mesh), member);
            }
            rtcCommitScene(group->second);
        }
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, group->second);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, first.toWorld.data());
        return geometry;
    }

    static void attach(RTCScene scene, RTCGeometry geometry, size_t id) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, unsigned(id));
        rtcReleaseGeometry(geometry);
    }

    template <class G>
    RTCGeometry user(const Shape& shape) {
        userShapes.push_back(std::make_unique<const Shape>(shape));
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, 1);
        rtcSetGeometryUserData(geometry, const_cast<Shape*>(userShapes.back().get()));
        rtcSetGeometryBoundsFunction(geometry, boundsOfShape, nullptr);
        rtcSetGeometryIntersectFunction(geometry, intersectUser<G>);
        rtcSetGeometryOccludedFunction(geometry, occludedUser<G>);
        return geometry;
    }

    void check() const {
        const RTCError error = rtcGetDeviceError(device);
        if (error != RTC_ERROR_NONE) fail(ExitCode::InvalidConfig, "Embree reports error {} while building the scene", int(error));
    }
};

RayTracer::RayTracer() = default;
RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

RayTracer::RayTracer(std::span<const Shape> shapes) : embree_(std::make_unique<Embree>()) {
    embree_->scene = rtcNewScene(embree_->device);
    for (size_t i = 0; i < shapes.size(); ++i) {
        const auto& geometry = shapes[i].geometry;
        const auto add = [&](RTCGeometry built) { Embree::attach(embree_->scene, built, i); };
        if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) {
            add(embree_->triangles(*mesh));
        } else if (const MeshInstance* instance = std::get_if<MeshInstance>(&geometry)) {
            if (instance->member == 0) add(embree_->instance(shapes.subspan(i)));
        } else if (std::holds_alternative<Disk>(geometry)) {
            add(embree_->user<Disk>(shapes[i]));
        } else if (std::holds_alternative<Cylinder>(geometry)) {
            add(embree_->user<Cylinder>(shapes[i]));
        } else {
            add(embree_->sphere(std::get<Sphere>(geometry)));
        }
    }
    rtcCommitScene(embree_->scene);
    embree_->check();
}

bool RayTracer::intersect(const Vec3f& origin, const Vec3f& direction, Hit& hit) const {
    RTCRayHit ray;
    set(ray.ray, origin, direction, kInfinity);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect1(embree_->scene, ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    // An instance has the number of its first shape, and its geometries count on from there.
    const uint32_t first = ray.hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? 0 : ray.hit.instID[0];
    hit = {first + ray.hit.geomID, ray.hit.primID, ray.ray.tfar, {ray.hit.u, ray.hit.v}};
    return true;
}

bool RayTracer::occluded(const Vec3f& origin, const Vec3f& segment) const {
    RTCRay ray;
    set(ray, origin, segment, 1);
    occluded1(embree_->scene, ray);
    return ray.tfar < 0;
}

bool RayTracer::occludedToInfinity(const Vec3f& origin, const Vec3f& direction) const {
    RTCRay ray;
    set(ray, origin, direction, kInfinity);
    occluded1(embree_->scene, ray);
    return ray.tfar < 0;
}

TreeMemory treeMemory(std::span<const Shape> shapes) {
    // Embree 3.13.5, one thread, meshes of 1e3 to 4e6 triangles (a height field, a cloud of small ones, long thin ones):
    // 86 to 112 bytes a triangle while it builds, 53 to 80 afterwards. 1e5 instances, spheres, or meshes of two triangles:
    // 420 to 660 bytes each, of which 300 to 480 are the geometry's own and not the tree's.
    constexpr double kBuilding = 110, kBuilt = 70, kGeometry = 480;
    double primitives = 0, geometries = 0, copies = 0;
    std::set<const Mesh*> grouped;
    for (const Shape& shape : shapes) {
        if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) {
            primitives += double(mesh->triangles.size());
        } else if (const MeshInstance* instance = std::get_if<MeshInstance>(&shape.geometry)) {
            const bool isNew = grouped.insert(instance->mesh.get()).second;
            if (isNew) primitives += double(instance->mesh->triangles.size());
            if (instance->member > 0) {  // part of an instance that is counted
                geometries += isNew;
                continue;
            }
            geometries += isNew;
            ++primitives;
        } else {
            ++primitives;
            if (!std::holds_alternative<Sphere>(shape.geometry)) ++copies;
        }
        ++geometries;
    }
    const double fixed = geometries * kGeometry + copies * sizeof(Shape);
    return {primitives * kBuilding + fixed, primitives * kBuilt + fixed};
}

std::string rayTracerInstructions() {
    const RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    const bool rays16 = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
    const bool rays8 = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
    rtcReleaseDevice(device);
    if (rays16) return "avx512";
    if (!rays8) return "sse";
    return __builtin_cpu_supports("avx2") ? "avx2" : "avx";  // Embree does not say which
}

}  // namespace ulam
