#include "core/scene/ray_tracer.h"

#include "core/base/error.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <xmmintrin.h>

#include <limits>

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

}  // namespace

struct RayTracer::Embree {
    // One thread builds, so that the tree is the same every time.
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = nullptr;

    ~Embree() {
        if (scene) rtcReleaseScene(scene);
        rtcReleaseDevice(device);
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
    RTCDevice device = embree_->device;
    embree_->scene = rtcNewScene(device);
    for (size_t i = 0; i < shapes.size(); ++i) {
        RTCGeometry geometry;
        if (const Mesh* mesh = std::get_if<Mesh>(&shapes[i].geometry)) {
            geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
            auto* p = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                  sizeof(Vec3f), mesh->positions.size()));
            auto* t = static_cast<std::array<uint32_t, 3>*>(rtcSetNewGeometryBuffer(
                geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(mesh->triangles[0]), mesh->triangles.size()));
            if (!p || !t) embree_->check();
            std::copy(mesh->positions.begin(), mesh->positions.end(), p);
            std::copy(mesh->triangles.begin(), mesh->triangles.end(), t);
        } else {
            const Sphere& sphere = std::get<Sphere>(shapes[i].geometry);
            geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
            auto* p = static_cast<float*>(
                rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
            p[0] = sphere.center.x, p[1] = sphere.center.y, p[2] = sphere.center.z, p[3] = sphere.radius;
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(embree_->scene, geometry, unsigned(i));
        rtcReleaseGeometry(geometry);
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
    hit = {ray.hit.geomID, ray.hit.primID, ray.ray.tfar, {ray.hit.u, ray.hit.v}};
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

}  // namespace ulam
