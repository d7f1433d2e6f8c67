#pragma once
// Mixtures and reliefs at one point of a surface. To those who scatter light they look like any BSDF
// (core/scene/bsdfs/scattering.h); what is nested in them may be a layer again.

#include "core/path/path.h"

namespace ulam {

/// Calls `function(bsdf)` with a coating as it is at v.
template <class Function>
decltype(auto) withCoating(const Scene& scene, const Vertex& v, const Coating& coating, Function&& function);

/// f_s and densities are sums over the parts. Delta lobes of one kind lead the same way from all parts, so they are one
/// lobe.
class MixtureAt {
public:
    static constexpr bool hasDelta = true, hasSmooth = true, transmits = true;

    MixtureAt(const Scene& scene, const Vertex& v, const Mixture& mixture);

    bool anisotropic() const { return true; }
    double albedo() const;
    double smoothShare(const Vec3f& from) const;

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        Color<T> sum(T(0));
        for (size_t i = 0; i < size(); ++i)
            if (shares_[i] > 0)
                sum += part(i, [&](const auto& bsdf) { return bsdf.eval(toLight, toCamera, lobe); }) * T(shares_[i]);
        return sum;
    }
    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        T sum(0);
        for (size_t i = 0; i < size(); ++i)
            if (shares_[i] > 0) sum += part(i, [&](const auto& bsdf) { return bsdf.pdf(from, to, lobe); }) * shares_[i];
        return sum;
    }
    template <class T>
    T probability(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        T sum(0);
        for (size_t i = 0; i < size(); ++i)
            if (shares_[i] > 0)
                sum += part(i,
                            [&](const auto& bsdf) -> T {
                                // A delta lobe may be there for one side only.
                                return isDelta(lobe) && !(bsdf.pdf(from, to, lobe) > 0)
                                           ? T(0)
                                           : bsdf.probability(from, to, lobe);
                            }) *
                       shares_[i];
        return sum;
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, Block u) const;
    std::optional<ScatterSample> sample(const Vec3f& from, Block u) const;
    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const;

    size_t size() const { return mixture_.parts.size(); }
    double share(size_t i) const { return shares_[i]; }
    template <class Function>
    decltype(auto) part(size_t i, Function&& function) const {
        return withCoating(scene_, v_, mixture_.parts[i], function);
    }

private:
    using Weights = std::array<double, Mixture::kMaxParts>;
    /// Probabilities of leaving by the smooth lobe of each part, or by its others.
    Weights lobeWeights(const Vec3f& from, bool smooth) const;

    const Scene& scene_;
    const Vertex& v_;
    const Mixture& mixture_;
    Weights shares_{};
};

/// As Mitsuba 3: the nested BSDF in the frame of the other normal, with that normal's cosine at the light's side; no
/// light from where it comes to the two normals' different sides. δ_σ of nested delta lobes has the other normal's
/// cosines.
class ReliefAt {
public:
    static constexpr bool hasDelta = true, hasSmooth = true, transmits = true;

    ReliefAt(const Scene& scene, const Vertex& v, const Relief& relief);

    bool anisotropic() const { return true; }
    double albedo() const;
    double smoothShare(const Vec3f& from) const;

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        using std::abs;
        const Direction<T> l = turned(toLight), c = turned(toCamera);
        if (!(l.z * toLight.z > 0 && abs(toLight.z) > kGrazing)) return Color<T>(T(0));
        return nested([&](const auto& bsdf) { return bsdf.eval(l, c, lobe); }) * (l.z / toLight.z);
    }
    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        return nested([&](const auto& bsdf) { return bsdf.pdf(turned(from), turned(to), lobe); });
    }
    template <class T>
    T probability(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        return nested([&](const auto& bsdf) { return bsdf.probability(turned(from), turned(to), lobe); });
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const;
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const;
    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const;

    /// A direction in the frame of the other normal.
    template <class T>
    Direction<T> turned(const Direction<T>& w) const {
        const auto along = [&w](const Vec3f& axis) { return T(axis.x) * w.x + T(axis.y) * w.y + T(axis.z) * w.z; };
        return {along(frame_.s), along(frame_.t), along(frame_.n)};
    }
    template <class Function>
    decltype(auto) nested(Function&& function) const {
        return withCoating(scene_, v_, relief_.nested[0], function);
    }

private:
    /// On which side light comes that runs along the surface is rounding.
    static constexpr double kGrazing = 1e-6;

    std::optional<ScatterSample> turnedBack(std::optional<ScatterSample> sample) const;

    const Scene& scene_;
    const Vertex& v_;
    const Relief& relief_;
    Frame frame_;
};

}  // namespace ulam
