// ulam bench: how fast the samplers are, as fractions of what Embree alone gives on the same scene.

#include <algorithm>
#include <chrono>

#include "core/render/driver.h"
#include "core/scene/load.h"
#include "experiments/cli/commands.h"

namespace ulam {
namespace {

// A few triangles and a sphere, where what is around the rays costs as much as they do; and a million triangles, where rays
// dominate. Paths have up to 8 edges and there is no Russian roulette, so that nothing is gained by ending paths early.
struct BenchScene {
    const char* name;
    const char* description;
};
constexpr BenchScene kScenes[] = {{"cornell_box", R"({"type": "cornell_box", "variant": "glass_sphere"})"},
                                  {"terrain", R"({"type": "terrain"})"}};
constexpr const char* kBenchFilm = R"({"width": 512, "height": 512, "rfilter": {"type": "box"}})";
constexpr const char* kLimits = R"("max_depth": 8, "rr_depth": 1000000)";

struct Case {
    const char* name;
    const char* parameters;
};
constexpr Case kCases[] = {
    {"path", R"("type": "path")"},
    {"bdpt", R"("type": "bdpt")"},
    {"pssmlt over path", R"("type": "pssmlt", "base": "path")"},
    {"pssmlt over bdpt", R"("type": "pssmlt", "base": "bdpt")"},
    {"mlt (Veach's mix)",
     R"("type": "mlt", "mutations": {"bidirectional": {"weight": 0.5}, "lens": {}, "caustic": {}, "multi_chain": {}})"},
};

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Rays a second of one thread, each starting where the last one ended and bouncing as off a diffuse surface.
double ceiling(const Scene& scene) {
    std::vector<std::vector<Vec3f>> normals(scene.shapes.size());
    for (size_t i = 0; i < scene.shapes.size(); ++i)
        if (const Mesh* mesh = std::get_if<Mesh>(&scene.shapes[i].geometry))
            for (const auto& t : mesh->triangles)
                normals[i].push_back(normalize(cross(mesh->positions[t[1]] - mesh->positions[t[0]],
                                                     mesh->positions[t[2]] - mesh->positions[t[0]])));
    const Vertex eye = scene.sensor->samplePosition({});
    const Vec3f start = eye.position, ahead = scene.sensor->direction(eye, {256, 256});
    const float offset = 1e-4f * scene.bounds().radius;
    uint64_t state = 88172645463325252ull;
    const auto uniform = [&state] {
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        return float(state >> 40) * 0x1p-24f;
    };
    constexpr int kRays = 1'500'000;
    Vec3f o = start, w = ahead;
    const double begin = now();
    for (int i = 0; i < kRays; ++i) {
        Hit hit;
        if (!scene.rays().intersect(o, w, hit)) {
            o = start, w = ahead;
            continue;
        }
        const Vec3f p = o + w * hit.distance;
        const Sphere* sphere = std::get_if<Sphere>(&scene.shapes[hit.shape].geometry);
        Vec3f n = sphere ? (p - sphere->center) / sphere->radius : normals[hit.shape][hit.primitive];
        if (dot(n, w) > 0) n = -n;
        const float z = 1 - 2 * uniform(), phi = 2 * float(kPi) * uniform(), r = std::sqrt(std::max(0.0f, 1 - z * z));
        const Vec3f u = n + Vec3f(r * std::cos(phi), r * std::sin(phi), z);
        o = p + n * offset;
        w = u / std::sqrt(std::max(1e-12f, length2(u)));
    }
    return kRays / (now() - begin);
}

struct Rates {
    double rays, units, raysPerUnit;
    double ceiling = 0;  ///< of the same moment
    double fraction(int threads) const { return rays / ceiling / threads; }
};

Rates measureOnce(const Scene& scene, const Case& c, int threads, double seconds) {
    const auto document = JsonDocument::fromText(fmt::format("{{{}, {}}}", c.parameters, kLimits), c.name);
    const auto sampler = Registry<Sampler>::instance().create(document.root());
    RenderOptions options;
    options.budget.seconds = seconds;
    options.threads = threads;
    options.key = makeKey(1);
    const RenderResult r = render(scene, *sampler, options);
    const double units = double(sampler->isChainSampler() ? r.statistics.mutations : r.statistics.samples);
    const double working = r.wallSeconds - r.statistics.seedingSeconds,
                 rays = double(r.statistics.rays) - double(r.statistics.seedingRays);
    return {.rays = rays / working, .units = units / working, .raysPerUnit = rays / units};
}

/// Machines are noisy and change their pace: each of several short measurements stands between two of the ceiling. The
/// one with the median fraction counts.
Rates measure(const Scene& scene, const Case& c, int threads, double seconds) {
    constexpr int kRepeats = 5;
    std::vector<Rates> all;
    double before = ceiling(scene);
    for (int i = 0; i < kRepeats; ++i) {
        all.push_back(measureOnce(scene, c, threads, seconds / kRepeats));
        const double after = ceiling(scene);
        all.back().ceiling = (before + after) / 2;
        before = after;
    }
    std::sort(all.begin(), all.end(), [&](const Rates& a, const Rates& b) { return a.fraction(threads) < b.fraction(threads); });
    return all[kRepeats / 2];
}

/// Appends a record of each case.
void benchScene(const BenchScene& which, double seconds, bool json, Json& cases) {
    const auto description = SceneDescription::fromNode(JsonDocument::fromText(which.description, "bench").root(), ".");
    const Scene scene = description.build(Json::parse(kBenchFilm));
    for (const Case& c : kCases) {
        double single = 0;  // units per ceiling ray: what two threads do more is not the machine's change of pace
        for (int threads = 1; threads <= 2; ++threads) {
            const Rates r = measure(scene, c, threads, seconds);
            const double fraction = r.units / r.ceiling;
            if (threads == 1) single = fraction;
            cases.push_back({{"scene", which.name},
                             {"sampler", c.name},
                             {"threads", threads},
                             {"embree_ceiling_rays_per_second", r.ceiling},
                             {"rays_per_second", r.rays},
                             {"units_per_second", r.units},
                             {"rays_per_unit", r.raysPerUnit},
                             {"rays_per_ceiling_ray", r.fraction(threads)},
                             {"units_per_ceiling_ray", fraction / threads},
                             {"speedup", fraction / single}});
            if (!json)
                fmt::print("{:<12} {:<18} {:>7} {:>11.3e} {:>11.3e} {:>10.2f} {:>13.3f} {:>14.4f} {:>9.2f}\n", which.name, c.name, threads, r.rays,
                           r.units, r.raysPerUnit, r.fraction(threads), fraction / threads, fraction / single);
            std::fflush(stdout);
        }
    }
}

void bench(const std::string& only, double seconds, bool json) {
    Json out = {{"cases", Json::array()}};
    if (!json)
        fmt::print("{:<12} {:<18} {:>7} {:>11} {:>11} {:>10} {:>13} {:>14} {:>9}\n", "scene", "sampler", "threads", "rays/s", "units/s",
                   "rays/unit", "rays/ceiling", "units/ceiling", "speed-up");
    for (const BenchScene& scene : kScenes)
        if (only.empty() || only == scene.name) benchScene(scene, seconds, json, out["cases"]);
    if (json)
        fmt::print("{}\n", dump(out));
    else
        fmt::print(
            "units: samples (path, bdpt) or mutations; fractions are per thread, of one thread's dependent Embree rays "
            "on this scene\n");
}

}  // namespace

void addBenchCommand(CLI::App& app) {
    auto* command =
        app.add_subcommand("bench", "Measure rays, samples and mutations a second against Embree's own speed");
    auto seconds = std::make_shared<double>(5);
    auto json = std::make_shared<bool>(false);
    auto only = std::make_shared<std::string>();
    std::vector<std::string> names;
    for (const BenchScene& scene : kScenes) names.emplace_back(scene.name);
    command->add_option("--scene", *only, "one of them; both unless given")->check(CLI::IsMember(names));
    command->add_option("--seconds", *seconds, "of each measurement")
        ->capture_default_str()
        ->check(CLI::Range(0.1, 600.0));
    command->add_flag("--json", *json, "JSON on the standard output");
    command->callback([only, seconds, json] { bench(*only, *seconds, *json); });
}

}  // namespace ulam
