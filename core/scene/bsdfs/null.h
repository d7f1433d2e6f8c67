#pragma once
// null: a surface that is not there; everything goes straight through (Mitsuba 3 `null`).

#include "core/scene/bsdfs/scattering.h"

namespace ulam {

struct Null {
    struct Parameters {
        template <class V>
        void describe(V&) {}
    };
    explicit Null(const Parameters&) {}

    static constexpr bool hasDelta = true, hasSmooth = false, transmits = true;

    template <class V>
    static void textured(V&) {}

    double albedo() const { return 1; }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        return Color<T>(T(goesThrough(toLight, toCamera, lobe) ? 1 : 0));
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        using std::abs;
        return goesThrough(from, to, lobe) ? abs(to.z) : T(0);
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Null ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block&) const {
        if (lobe != Lobe::Null || from.z == 0) return std::nullopt;
        return ScatterSample{-from, Lobe::Null};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Null, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block&) const { return goesThrough(from, to, lobe); }
};

}  // namespace ulam
