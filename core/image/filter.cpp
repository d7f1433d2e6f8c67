#include "core/image/filter.h"

#include <boost/math/tools/roots.hpp>
#include <tuple>

namespace ulam {
namespace {

double bell(double x, double stddev) {
    return std::exp(-x * x / (2 * stddev * stddev));
}
/// ∫ bell from 0 to x.
double bellIntegral(double x, double stddev) {
    return stddev * std::sqrt(kPi / 2) * std::erf(x / (stddev * std::numbers::sqrt2));
}

}  // namespace

// The bell is lowered by its value at the radius, so that the filter ends without a step.
ReconstructionFilter::ReconstructionFilter(const GaussianParameters& p)
    : type_(Type::Gaussian), radius_(4 * p.stddev), stddev_(p.stddev), atRadius_(bell(radius_, stddev_)) {
    normalization_ = 1 / (2 * (bellIntegral(radius_, stddev_) - atRadius_ * radius_));
}

double ReconstructionFilter::operator()(double x) const {
    // Half open, so that a point on the border of two pixels belongs to one of them.
    if (!(x >= -radius_ && x < radius_)) return 0;
    switch (type_) {
        case Type::Box:
            return 1;
        case Type::Tent:
            return (1 - std::abs(x) / radius_) / radius_;
        case Type::Gaussian:
            return std::max(0.0, bell(x, stddev_) - atRadius_) * normalization_;
    }
    return 0;
}

double ReconstructionFilter::squareIntegral() const {
    switch (type_) {
        case Type::Box:
            return 1;
        case Type::Tent:
            return 2 / (3 * radius_);
        case Type::Gaussian: {
            // The square of a bell is a bell of the √2-th width.
            const double square = bellIntegral(radius_, stddev_ / std::numbers::sqrt2);
            const double half = square - 2 * atRadius_ * bellIntegral(radius_, stddev_) + atRadius_ * atRadius_ * radius_;
            return 2 * half * normalization_ * normalization_;
        }
    }
    return 0;
}

double ReconstructionFilter::sample(double u) const {
    const double centred = u - 0.5, tail = std::abs(centred);
    switch (type_) {
        case Type::Box:
            return centred;
        case Type::Tent:
            return std::copysign(radius_ * (1 - std::sqrt(1 - 2 * tail)), centred);
        case Type::Gaussian: {
            // Solves ∫ h from 0 to x = tail; Newton's step is kept inside a bracket, because h vanishes at the radius.
            const auto integral = [&](double x) {
                return std::make_tuple((bellIntegral(x, stddev_) - atRadius_ * x) * normalization_ - tail, (*this)(x));
            };
            const double guess = std::min(radius_ / 2, tail / (*this)(0));
            return std::copysign(boost::math::tools::newton_raphson_iterate(integral, guess, 0.0, radius_, 48),
                                 centred);
        }
    }
    return 0;
}

}  // namespace ulam
