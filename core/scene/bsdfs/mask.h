#pragma once
// mask: light meets the nested BSDF with probability `opacity`, and otherwise goes straight through (Mitsuba 3 `mask`). Not
// a BSDF of its own but a view of one: what covers a surface keeps the opacity beside the BSDF.
//
// Where the nested BSDF has a Null lobe itself, both are one lobe: the light that goes straight through is their sum.

#include "core/scene/bsdfs/scattering.h"

namespace ulam {

template <class B>
struct Masked {
    Masked(const B& bsdf, double o) : nested(bsdf), opacity(std::clamp(o, 0.0, 1.0)) {}

    static constexpr bool hasDelta = true, hasSmooth = B::hasSmooth, hasNull = true, transmits = true;

    bool anisotropic() const
        requires requires(const B& b) { b.anisotropic(); }
    {
        return nested.anisotropic();
    }

    double albedo() const { return 1 - opacity + opacity * nested.albedo(); }

    double smoothShare(const Vec3f& from) const
        requires(hasSmooth)
    {
        return opacity * smoothShareOf(nested, from);
    }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        const Color<T> masked = nested.eval(toLight, toCamera, lobe) * T(opacity);
        return goesThrough(toLight, toCamera, lobe) ? masked + Color<T>(T(1 - opacity)) : masked;
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        using std::abs;
        const T masked = nested.pdf(from, to, lobe) * opacity;
        return goesThrough(from, to, lobe) ? masked + abs(to.z) * (1 - opacity) : masked;
    }

    template <class T>
    T probability(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (lobe != Lobe::Null) return nested.probability(from, to, lobe) * opacity;
        return T(1 - opacity) + nestedNull(from, to) * opacity;
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (lobe != Lobe::Null) return nested.sampleLobe(from, lobe, u);
        if (from.z == 0) return std::nullopt;
        return ScatterSample{-from, Lobe::Null};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, Block u) const {
        if (u[2] < 1 - opacity) return sampleLobe(from, Lobe::Null, u);
        u[2] = (u[2] - (1 - opacity)) / opacity;
        return nested.sample(from, u);
    }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (lobe == Lobe::Null) {
            if (!goesThrough(from, to, lobe)) return false;
            // Which of the two sent it: the cut, or the nested BSDF.
            const double cut = 1 - opacity, through = nestedNull(Vec3d(from), Vec3d(to)) * opacity, all = cut + through;
            if (all <= 0) return false;
            u[2] *= all;
            if (u[2] < cut) return true;
            u[2] = (u[2] - cut) / through;
        }
        if (opacity == 0 || !nested.invert(from, to, lobe, u)) return false;
        u[2] = 1 - opacity + u[2] * opacity;
        return true;
    }

    const B& nested;
    double opacity;

private:
    /// Probability that the nested BSDF lets light through.
    template <class T>
    T nestedNull(const Direction<T>& from, const Direction<T>& to) const {
        if constexpr (B::hasNull)
            return nested.probability(from, to, Lobe::Null);
        else
            return T(0);
    }
};

}  // namespace ulam
