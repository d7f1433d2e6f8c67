#include "core/scene/bsdfs/fresnel.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>

namespace ulam {

double diffuseFresnelFromInside(double ior) {
    const double ratio = std::max(ior, 1 / ior);
    const auto integrand = [&](double cosThin) { return 2 * cosThin * fresnelFromThinSide(cosThin, ratio); };
    const double fromThin = boost::math::quadrature::gauss_kronrod<double, 15>::integrate(integrand, 0, 1, 15, 1e-12);
    // Both sides exchange the same étendue: η² (1 − R_i) = 1 − R_e. From the thin side there is no critical angle.
    return ior > 1 ? 1 - (1 - fromThin) / (ior * ior) : fromThin;
}

}  // namespace ulam
