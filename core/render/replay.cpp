#include "core/render/replay.h"

#include "core/config/json_number.h"

namespace ulam {
namespace {

Json vector(const Vec3f& v) { return {numberOrText(v.x), numberOrText(v.y), numberOrText(v.z)}; }
Json color(const Spectrum& c) { return {numberOrText(c.x), numberOrText(c.y), numberOrText(c.z)}; }
Json raster(const Vec2f& r) { return {numberOrText(r.x), numberOrText(r.y)}; }

Json describe(const Scene& scene, const Vertex& v) {
    constexpr const char* kinds[] = {"surface", "lens", "point", "infinite", "direction"};
    constexpr const char* lobes[] = {"smooth", "delta_reflection", "delta_transmission", "null"};
    Json json = {{"kind", kinds[int(v.kind)]}, {v.atInfinity() ? "towards" : "position", vector(v.position)}};
    if (v.hasNormal()) json["normal"] = vector(v.normal);
    if (v.onSurface()) {
        json["shading_normal"] = vector(v.shadingNormal);
        json["shape"] = v.shape;
        json["primitive"] = v.primitive;
        json["uv"] = {numberOrText(v.uv.x), numberOrText(v.uv.y)};
        json["lobe"] = lobes[int(v.lobe)];
    }
    if (const uint32_t e = scene.emitterAt(v); e != kNone) json["emitter"] = e;
    return json;
}

void tellCause(Json& json) {
    if (const Cause cause = takeCause(); cause != Cause::None) json["refused"] = name(cause);
}

Json describeWalk(const Scene& scene, const Subpath& walk) {
    Json vertices = Json::array();
    for (int i = 0; i < walk.size; ++i) {
        Json v = describe(scene, walk.vertex[size_t(i)]);
        v["density"] = numberOrText(walk.forward[size_t(i)]);
        v["throughput"] = color(walk.throughput[size_t(i)]);
        vertices.push_back(std::move(v));
    }
    return vertices;
}

Json describeState(const Scene& scene, const BidirectionalOptions& options, const Sample& x) {
    Json json = {{"log_target", numberOrText(x.logTarget)}};
    if (x.path.size() >= 2) json["path"] = describePath(scene, options.limits, x.path);
    if (x.u.size(NumberStream::Camera) == 0 || x.path.size() > 0) return json;
    Json& all = json["numbers"] = Json::object();
    constexpr const char* streams[] = {"light", "camera", "connect"};
    for (const NumberStream s : {NumberStream::Light, NumberStream::Camera, NumberStream::Connect})
        for (int i = 0; i < x.u.size(s); ++i)
            for (const double u : x.u(s, i)) all[streams[int(s)]].push_back(numberOrText(u));
    PrimaryVector u = x.u;
    Random none;
    Numbers numbers(u, none);
    json["sample"] = describeSample(scene, options, scene.sensor->sampleRaster(u(NumberStream::Camera, 0)), numbers);
    return json;
}

}  // namespace

Json describePath(const Scene& scene, const PathLimits& limits, const Path& path) {
    takeCause();  // of what came before
    Json json = {{"vertices", Json::array()}, {"edges", Json::array()}};
    PathFactors factors;
    factors.size = path.size();
    const int k = path.length();
    bool finite = true;
    for (int i = 0; i <= k; ++i) {
        Json v = describe(scene, path[i]);
        if (i < k) {
            const Edge& edge = factors.edge[size_t(i)] = Edge(path[i], path[i + 1]);
            json["edges"].push_back({{"direction", vector(edge.direction)}, {"geometry", numberOrText(edge.geometry())}});
            finite = finite && std::isfinite(edge.geometry());
        }
        Scattering& at = factors.at[size_t(i)];
        if (i == 0) {
            const Emission e = emission(scene, path[0], factors.edge[0].direction);
            at = {e.radiance, e.pdf, 0};
        } else if (i == k) {
            const auto response = scene.sensor->respond(path[k], -factors.edge[size_t(k - 1)].direction);
            at = {Spectrum(response.importance), 0, response.pdf};
            json["raster"] = raster(response.raster);
        } else {
            at = scatter(scene, path[i], path[i].lobe, -factors.edge[size_t(i - 1)].direction, factors.edge[size_t(i)].direction);
        }
        v["f"] = color(at.f);
        v["pdf_to_camera"] = numberOrText(at.pdfToCamera);
        v["pdf_to_light"] = numberOrText(at.pdfToLight);
        tellCause(v);
        finite = finite && !v.contains("refused");
        json["vertices"].push_back(std::move(v));
    }
    json["contribution"] = color(factors.contribution());
    if (!finite) return json;
    const PathDensities d = densities(scene, limits, path, factors);
    for (int i = 0; i <= k; ++i) {
        json["vertices"][size_t(i)]["density_from_light"] = numberOrText(d.fromLight[size_t(i)]);
        json["vertices"][size_t(i)]["density_from_camera"] = numberOrText(d.fromCamera[size_t(i)]);
    }
    for (int s = 0; s < d.size; ++s)
        if (d.possible(s) && std::isfinite(d.log(s)))
            json["techniques"].push_back({{"s", s}, {"t", d.size - s}, {"log_density", numberOrText(d.log(s))},
                                          {"weight", numberOrText(d.weight(s, {}, Heuristic::Balance))}});
    tellCause(json);
    return json;
}

Json describeSample(const Scene& scene, const BidirectionalOptions& options, const Vec2f& where, Numbers& numbers) {
    takeCause();  // of what came before
    Json json = {{"raster", raster(where)}};
    Tracing tracing(scene);
    const PathLimits& limits = options.limits;
    Subpath walk;
    if (options.techniques.walkFromLight()) {
        walkFromLight(tracing, limits, limits.maxDepth, numbers, walk);
        json["light_walk"] = {{"vertices", describeWalk(scene, walk)}};
        tellCause(json["light_walk"]);
    }
    walkFromCamera(tracing, limits, limits.maxDepth + 1, where, numbers, walk);
    json["camera_walk"] = {{"vertices", describeWalk(scene, walk)}};
    tellCause(json["camera_walk"]);

    Json& contributions = json["contributions"] = Json::array();
    BidirectionalSampler sampler(scene, options);
    sampler.sample(where, numbers, [&](const Contribution& c) {
        Json one = {{"s", c.technique.s}, {"t", c.technique.t}, {"value", color(c.value)}, {"weight", numberOrText(c.weight)}};
        tellCause(one);
        if (!isFinite(c.value)) {
            Path path;
            sampler.join(c.technique, path);
            one["path"] = describePath(scene, limits, path);
        }
        contributions.push_back(std::move(one));
    });
    tellCause(json);
    return json;
}

Json describeStep(const Scene& scene, const BidirectionalOptions& options, const MutationMix& mix, const Chain& before,
                  const Proposal& proposal, const StepInfo& info) {
    Json json = {{"chain", before.index}, {"step", before.step}, {"rejected", name(info.reject)}, {"acceptance", numberOrText(info.acceptance)}};
    if (info.cause != Cause::None) json["refused"] = name(info.cause);
    if (info.mutation >= 0) json["mutation"] = mix[size_t(info.mutation)].name;
    json["log_forward"] = numberOrText(proposal.logForward);
    json["log_reverse"] = numberOrText(proposal.logReverse);
    json["log_jacobian"] = numberOrText(proposal.logJacobian);
    json["current"] = describeState(scene, options, before.x);
    json["proposal"] = describeState(scene, options, proposal.y);
    return json;
}

}  // namespace ulam
