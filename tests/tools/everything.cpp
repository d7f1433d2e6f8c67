// Every sampler and every mutation for a moment, for builds with a sanitizer, which watch what happens; what comes out is
// tested elsewhere. Prints the SHA-256 of each image, to be the same in every build. Arguments: a factor for the work, and
// the number of threads. Only the layers up to samplers and mutations, so that it builds quickly.

#include <cstdio>
#include <cstdlib>

#include "core/base/sha256.h"
#include "core/mcmc/audit/balance.h"
#include "core/mcmc/audit/jacobian.h"
#include "core/mcmc/audit/structure.h"
#include "core/render/driver.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

/// A scene of the tests, with features in front of the camera for the samplers that need some.
Scene sceneOf(const std::string& name) {
    Scene scene = buildScene(pathScene(name).dictionary, {{"width", 17}, {"height", 11}});
    if (scene.features.empty())
        scene.features = {{-0.8f, 1.6f, 1}, {1.6f, 0, 0}, {0, -1.2f, 0}, 2, 2, {"a", "b", "c", "d"}};
    return scene;
}

int failures = 0;

void renderEverything(const std::string& sceneName, double scale, int threads) {
    const Scene scene = sceneOf(sceneName);
    for (const auto* entry : Registry<Sampler>::instance().entries()) {
        Json config = {{"type", entry->name}, {"max_depth", 6}};
        if (entry->create(JsonNode(Json{{"type", entry->name}}))->isChainSampler()) config["chains"] = 9, config["bootstrap"] = 400;
        RenderOptions options;
        options.budget.spp = 8 * scale;
        options.key = makeKey(1);
        options.threads = threads;
        options.snapshots = 2;
        const RenderResult result = render(scene, *entry->create(JsonNode(config)), options);
        double sum = 0;
        for (const Rgb& p : result.image.pixels) sum += double(p.x) + p.y + p.z;
        const auto& pixels = result.image.pixels;
        const std::string hash = sha256({reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof(Rgb)});
        std::printf("%s, %s: %s\n", sceneName.c_str(), entry->name.c_str(), hash.c_str());
        if (sum > 0) continue;
        std::printf("%s: the image of %s is black\n", entry->name.c_str(), sceneName.c_str());
        ++failures;
    }
}

void report(const std::string& mutation, const char* level, const audit::Failures& found) {
    for (const auto& failure : found.first()) std::printf("%s, %s: %s\n", mutation.c_str(), level, failure.message.c_str());
    failures += int(found.count());
}

void auditEverything(double scale) {
    const RandomKey key = makeKey(2);
    const auto count = uint64_t(60 * scale);
    for (const auto* entry : Registry<Mutation>::instance().entries()) {
        const bool primary = entry->create(JsonNode(Json{{"type", entry->name}}))->space() == Space::Primary;
        for (const Space target : {Space::Path, Space::Primary}) {
            if (target == Space::Primary && !primary) continue;
            const audit::Subject subject(entry->name, target, audit::partnersOf(entry->name, target));
            for (const auto& scene : audit::auditScenes()) {
                const audit::States states = audit::drawStates(*scene, subject, key, 10 * count, 20);
                if (states.x.empty()) continue;
                report(entry->name, "structure", audit::auditStructure(*scene, subject, states, key, 0, count).failures);
                report(entry->name, "balance", audit::auditBalance(*scene, subject, states, key, 0, count).failures);
                audit::auditJacobian(*scene, subject, states, key, 0, count);
            }
        }
    }
}

}  // namespace

int main(int argc, char* argv[]) {
    const double scale = argc > 1 ? std::atof(argv[1]) : 1;
    const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
    for (const char* scene : {"glass_and_mirror", "thin_lens"}) renderEverything(scene, scale, threads);
    auditEverything(scale);
    return failures == 0 ? 0 : 1;
}
