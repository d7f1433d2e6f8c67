#include "core/path/bidirectional.h"

namespace ulam {

std::optional<std::string> missedLight(const Scene& scene, const TechniqueSet& set) {
    const bool specular = std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) { return m.hasDelta; });
    const bool deltaLight = std::any_of(scene.emitters.begin(), scene.emitters.end(), [](const Emitter& e) {
        return dispatch(e, [](const auto& emitter) { return emitter.positionIsDelta; });
    });
    if (!set.hitLight && specular) return "walks from the light cannot join mirrors and glass to the lens: what the camera sees directly in them is black";
    if (!set.connect && !set.lightImage && specular && deltaLight)
        return "walks from the camera cannot join mirrors and glass to a point, spot or directional light: its caustics are missing";
    return {};
}

void BidirectionalSampler::join(Technique technique, Path& path) const {
    const auto [s, t] = technique;
    const Subpath& light = s == 1 && t >= 2 ? direct_ : light_;
    path.resize(s + t);
    for (int i = 0; i < s; ++i) path[i] = light.vertex[i];
    for (int j = 0; j < t; ++j) path[s + t - 1 - j] = camera_.vertex[j];
    // The walks may have gone on from the vertices that are joined here.
    if (s > 0) path[s - 1].lobe = Lobe::Smooth;
    path[s].lobe = Lobe::Smooth;
}

namespace {
constexpr float kFar = 1e6f;  // along a ray to infinity: beyond every feature
}

uint32_t featureOf(const Features& features, const Path& path) {
    for (int i = path.length(); i > 0; --i) {
        const Vertex &a = path[i - 1], &b = path[i];
        const bool endless = a.atInfinity();
        const uint32_t label = features.crossed(b.position, endless ? b.position + a.position * kFar : a.position);
        if (label != kNone) return label;
    }
    return kNone;
}

}  // namespace ulam
