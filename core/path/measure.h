#pragma once
// Measures: the one place where densities are converted, and the geometry term.

#include "core/scene/vertex.h"

namespace ulam {

/// |cosθ| between a direction and the surface (or lens) at v; 1 where there is none.
inline double cosine(const Vertex& v, const Vec3f& w) { return v.hasNormal() ? std::abs(double(dot(v.normal, w))) : 1; }

/// An edge a–b: direction from a to b, and what the measures need.
struct Edge {
    Vec3f direction;     ///< unit, from a to b
    double cosA, cosB;   ///< |cosθ| at either end; 1 without surface
    double inverseD2;    ///< 1 / squared length; 1 where an end lies at infinity

    Edge() {}  // left open: arrays of edges are made often
    Edge(const Vertex& a, const Vertex& b) {
        if (a.atInfinity() || b.atInfinity()) {
            direction = directionTo(a, b);
            inverseD2 = 1;
        } else {
            const Vec3f d = b.position - a.position;
            const float d2 = length2(d);
            direction = d * (1 / std::sqrt(d2));
            inverseD2 = 1 / double(d2);
        }
        cosA = cosine(a, direction);
        cosB = cosine(b, direction);
    }

    template <class Archive>
    void archive(Archive& a) {
        a(direction, cosA, cosB, inverseD2);
    }

    /// G(a↔b) = |cosθ_a cosθ_b| / |a−b|²; a point at infinity contributes neither cosine nor distance.
    double geometry() const { return cosA * cosB * inverseD2; }
    /// Density of b per area from the density of the direction a→b per solid angle (from infinity: from the density
    /// per area of the scene's disc); of a direction b at infinity it stays per solid angle.
    double toAreaB(double pdfW) const { return pdfW * cosB * inverseD2; }
    double toAreaA(double pdfW) const { return pdfW * cosA * inverseD2; }
};

}  // namespace ulam
