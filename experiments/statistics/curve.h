#pragma once
// Error against cost inside one run, at its snapshots.

#include <vector>

namespace ulam::statistics {

struct CurvePoint {
    double cost = 0;  // seconds, rays or mutations, > 0
    double error = 0;
};

/// Of one replicate, cost ascending.
using Curve = std::vector<CurvePoint>;

}  // namespace ulam::statistics
