#pragma once
// Fresnel equations for unpolarised light (Born & Wolf, Principles of Optics, §1.5.2 and §13.4; Mitsuba 3 follows them too).

#include "core/base/vector.h"

namespace ulam {

/// Reflectance of a smooth dielectric interface. cosThin is |cosθ| on the side of lower index, ratio = higher/lower index.
/// Taken from the thin side, because there Snell's law is well conditioned up to total internal reflection.
template <class T>
T fresnelFromThinSide(T cosThin, double ratio) {
    using std::sqrt;
    const T cosDense = sqrt(T(1) - (T(1) - cosThin * cosThin) * (1 / (ratio * ratio)));
    const T s = (cosThin - ratio * cosDense) / (cosThin + ratio * cosDense);
    const T p = (ratio * cosThin - cosDense) / (ratio * cosThin + cosDense);
    return T(0.5) * (s * s + p * p);
}

/// |cosθ| on the thin side of a ray with |cosθ| = cosDense on the dense side; negative: total internal reflection.
template <class T>
T cosThinFromDense(T cosDense, double ratio) {
    using std::sqrt;
    const T c2 = T(1) - (T(1) - cosDense * cosDense) * (ratio * ratio);
    return c2 > T(0) ? sqrt(c2) : T(-1);
}

/// Reflectance of a smooth dielectric interface from either side, total internal reflection included.
template <class T>
T fresnelDielectric(T cosTheta, double ratio, bool fromThinSide) {
    if (fromThinSide) return fresnelFromThinSide(cosTheta, ratio);
    const T thin = cosThinFromDense(cosTheta, ratio);
    return thin < T(0) ? T(1) : fresnelFromThinSide(thin, ratio);
}

/// Part of diffuse light from inside that a smooth interface throws back; ior = interior over exterior.
double diffuseFresnelFromInside(double ior);

/// Reflectance of a conductor of complex index eta + i k against air.
template <class T>
T fresnelConductor(T cosTheta, double eta, double k) {
    using std::sqrt;
    const T c2 = cosTheta * cosTheta, s2 = T(1) - c2;
    const T t0 = T(eta * eta - k * k) - s2;
    const T a2b2 = sqrt(t0 * t0 + T(4 * eta * eta * k * k));
    // Zero under total reflection (eta = 0, a perfect mirror, say), where the root has no derivative.
    const T a2 = T(0.5) * (a2b2 + t0), a = a2 > T(0) ? sqrt(a2) : T(0);
    const T t1 = a2b2 + c2, t2 = T(2) * a * cosTheta;
    const T rs = (t1 - t2) / (t1 + t2);
    const T t3 = a2b2 * c2 + s2 * s2, t4 = t2 * s2;
    const T rp = rs * (t3 - t4) / (t3 + t4);
    return T(0.5) * (rs + rp);
}
template <class T>
Imath::Color3<T> fresnelConductor(T cosTheta, const Spectrum& eta, const Spectrum& k) {
    return {fresnelConductor(cosTheta, eta.x, k.x), fresnelConductor(cosTheta, eta.y, k.y), fresnelConductor(cosTheta, eta.z, k.z)};
}

}  // namespace ulam
