#include "core/path/layers.h"

#include "core/path/local_bsdf.h"
#include "core/scene/bsdfs/mixture.h"

namespace ulam {

MixtureAt::MixtureAt(const Scene& scene, const Vertex& v, const Mixture& mixture)
    : scene_(scene), v_(v), mixture_(mixture) {
    for (size_t i = 0; i < size(); ++i) {
        const Share& share = mixture.shares[i];
        const double value =
            share.texture == kNone
                ? share.constant
                : std::clamp(textureValue(scene.textures[share.texture], scene.shapes[v.shape].texcoord(v)), 0.0, 1.0);
        shares_[i] = share.rest ? 1 - value : value;
    }
}

double MixtureAt::albedo() const {
    double sum = 0;
    for (size_t i = 0; i < size(); ++i) sum += shares_[i] * part(i, [](const auto& bsdf) { return bsdf.albedo(); });
    return sum;
}

MixtureAt::Weights MixtureAt::lobeWeights(const Vec3f& from, bool smooth) const {
    Weights weights{};
    for (size_t i = 0; i < size(); ++i) {
        if (!(shares_[i] > 0)) continue;
        const double share = part(i, [&](const auto& bsdf) { return smoothShareOf(bsdf, from); });
        weights[i] = shares_[i] * (smooth ? share : 1 - share);
    }
    return weights;
}

double MixtureAt::smoothShare(const Vec3f& from) const {
    double sum = 0;
    for (const double weight : lobeWeights(from, true)) sum += weight;
    return sum;
}

std::optional<ScatterSample> MixtureAt::sampleLobe(const Vec3f& from, Lobe lobe, Block u) const {
    if (lobe == Lobe::Smooth) {
        const auto chosen = choosePart(lobeWeights(from, true), u[2]);
        if (!chosen) return std::nullopt;
        u[2] = chosen->within;
        return part(chosen->index, [&](const auto& bsdf) { return bsdf.sampleLobe(from, lobe, u); });
    }
    for (size_t i = 0; i < size(); ++i)
        if (shares_[i] > 0)
            if (auto sample = part(i, [&](const auto& bsdf) { return bsdf.sampleLobe(from, lobe, u); })) return sample;
    return std::nullopt;
}

std::optional<ScatterSample> MixtureAt::sample(const Vec3f& from, Block u) const {
    // Delta lobes have the lower end of u[2], here and in the parts; what is absorbed lies between.
    const bool smooth = u[2] >= 1 - smoothShare(from);
    const Weights weights = lobeWeights(from, smooth);
    double total = 0;
    for (const double weight : weights) total += weight;
    const double at = smooth ? u[2] - (1 - total) : u[2];
    if (!smooth && at >= total) return std::nullopt;
    const auto chosen = partAt(weights, at);
    if (!chosen) return std::nullopt;
    return part(chosen->index, [&](const auto& bsdf) {
        const double share = smoothShareOf(bsdf, from);
        u[2] = smooth ? 1 - share + share * chosen->within : (1 - share) * chosen->within;
        return bsdf.sample(from, u);
    });
}

bool MixtureAt::invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
    const Vec3d w(from), t(to);
    const bool smooth = !isDelta(lobe);
    Weights densities{};
    for (size_t i = 0; i < size(); ++i)
        if (shares_[i] > 0) densities[i] = shares_[i] * part(i, [&](const auto& bsdf) { return bsdf.pdf(w, t, lobe); });
    auto chosen = choosePart(densities, u[2]);
    if (!chosen) return false;
    u[2] = chosen->within;
    const bool inverted = part(chosen->index, [&](const auto& bsdf) {
        if (!bsdf.invert(from, to, lobe, u)) return false;
        const double share = smoothShareOf(bsdf, from);
        chosen->within = std::clamp(smooth ? (u[2] - (1 - share)) / share : u[2] / (1 - share), 0.0, 1.0);
        return true;
    });
    const Weights weights = lobeWeights(from, smooth);
    u[2] = numberOf(weights, *chosen);
    if (smooth) u[2] += 1 - smoothShare(from);
    return inverted;
}

ReliefAt::ReliefAt(const Scene& scene, const Vertex& v, const Relief& relief)
    : scene_(scene), v_(v), relief_(relief), frame_(Vec3f(0, 0, 1)) {
    const Shape& shape = scene.shapes[v.shape];
    const Texture& texture = scene.textures[relief.texture];
    const Vec2f uv = shape.texcoord(v);
    Vec3f n;
    if (relief.kind == Relief::Kind::Normals) {
        const Spectrum c = textureColor(texture, uv);
        n = Vec3f(Vec3d(2 * c.x - 1, 2 * c.y - 1, 2 * c.z - 1));
    } else {
        // The tangents of the surface raised by its heights, in the frame of the shading normal.
        const Tangents tangents = shape.tangents(v);
        const Frame base(v.shadingNormal, tangents.u);
        const Vec2f slope = textureSlope(texture, uv);
        Vec3f alongU = base.toLocal(tangents.u), alongV = base.toLocal(tangents.v);
        alongU.z = float(relief.scale) * slope.x;
        alongV.z = float(relief.scale) * slope.y;
        n = cross(alongU, alongV);
        if (dot(base.toLocal(v.normal), n) < 0) n = -n;
    }
    if (length2(n) > 0) frame_ = Frame(normalize(n), Vec3f(1, 0, 0));
}

double ReliefAt::albedo() const {
    return nested([](const auto& bsdf) { return bsdf.albedo(); });
}

double ReliefAt::smoothShare(const Vec3f& from) const {
    return nested([&](const auto& bsdf) { return smoothShareOf(bsdf, turned(from)); });
}

std::optional<ScatterSample> ReliefAt::turnedBack(std::optional<ScatterSample> sample) const {
    if (sample) sample->to = frame_.toWorld(sample->to);
    return sample;
}

std::optional<ScatterSample> ReliefAt::sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
    return turnedBack(nested([&](const auto& bsdf) { return bsdf.sampleLobe(turned(from), lobe, u); }));
}

std::optional<ScatterSample> ReliefAt::sample(const Vec3f& from, const Block& u) const {
    return turnedBack(nested([&](const auto& bsdf) { return bsdf.sample(turned(from), u); }));
}

bool ReliefAt::invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
    return nested([&](const auto& bsdf) { return bsdf.invert(turned(from), turned(to), lobe, u); });
}

}  // namespace ulam
