#include "tests/support/planted.h"

#include "core/mcmc/perturbation.h"
#include "core/mcmc/small_steps.h"
#include "core/mcmc/target.h"

namespace ulam::planted {
namespace {

enum class Bug {
    None,
    Geometry,  ///< density per solid angle where it must be per area
    Swapped,   ///< forward for reverse
    Blind,     ///< no visibility ray
    Overfull,  ///< the density is twice too large: it cancels in every ratio
};

struct NoParameters {
    template <class V>
    void describe(V&) {}
};

/// Moves the raster position of a path without specular vertices near the camera.
template <Bug bug, bool stated = true>
class Planted : public Mutation {
public:
    using Parameters = NoParameters;
    explicit Planted(const Parameters&) {}

    Space space() const override { return Space::Path; }
    double suitability(const Sample& x) const override {
        const int k = x.path.length();
        return k >= 2 && !isDelta(x.path[k - 1].lobe) && !isDelta(x.path[k - 2].lobe);
    }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        const Scene& scene = context.scene();
        const int k = x.path.length();
        const Vec2f raster = step_.sample(x.splats[0].raster, context.random.nextBlock());
        if (!scene.sensor->contains(raster)) {
            p.reject = Reject::OffScreen;
            return p;
        }
        PathEdit edit(x, k - 2, k, 2, context, p.y);
        if ((p.reject = edit.growFromCameraAlong(scene.sensor->direction(x.path.camera(), raster))) != Reject::None) return p;
        if constexpr (bug == Bug::Blind) {
            p.y.path[k - 1].lobe = p.y.path[k - 2].lobe = Lobe::Smooth;
            if (!evaluate(scene, p.y.path, k - 2, k, p.y.factors)) {
                p.reject = Reject::ZeroTarget;
                return p;
            }
        } else {
            if ((p.reject = edit.join()) != Reject::None) return p;
        }
        p.logForward = density(x, p.y, context);
        p.logReverse = density(p.y, x, context);
        return p;
    }

    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext& context) const override {
        return stated ? std::optional(density(from, to, context)) : std::nullopt;
    }

private:
    double density(const Sample& from, const Sample& to, StepContext& context) const {
        const auto& sensor = *context.scene().sensor;
        const int k = to.path.length();
        const auto respond = [&](const Sample& s) { return sensor.respond(s.path.camera(), -s.factors.edge[size_t(k - 1)].direction); };
        const auto a = respond(from), b = respond(to);
        if (!(a.pdf > 0 && b.pdf > 0)) return -std::numeric_limits<double>::infinity();
        const PathFactors& f = bug == Bug::Swapped ? from.factors : to.factors;
        const double camera = bug == Bug::Geometry ? f.at[size_t(k)].pdfToLight : f.fromCamera(k - 1);
        return std::log((bug == Bug::Overfull ? 2 : 1) * step_.pdf(a.raster, b.raster) * sensor.windowArea() * camera);
    }

    RasterPerturbation step_{0.1, 20};
};

/// Suits no state.
class Nowhere : public Planted<Bug::None> {
public:
    using Planted::Planted;
    double suitability(const Sample&) const override { return 0; }
};

/// Steps to one side only, and says nothing about it.
class Drift : public Mutation {
public:
    using Parameters = NoParameters;
    explicit Drift(const Parameters&) {}

    Space space() const override { return Space::Primary; }
    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        moveNumbers(x.u, p.y.u, context.random, [](double u, Random& random) { return wrapped(u, 0.05 * random()); });
        return p;
    }
};

/// Symmetric, so that no image shows it; but its steps are half as long as it says.
class Narrow : public Mutation {
public:
    using Parameters = NoParameters;
    explicit Narrow(const Parameters&) {}

    Space space() const override { return Space::Primary; }
    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        moveNumbers(x.u, p.y.u, context.random, [](double u, Random& random) { return wrapped(u, 0.05 * (random() - 0.5)); });
        return p;
    }
    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext&) const override {
        return logMoves(from.u, to.u, [](double d) {
            return std::abs(d) < 0.05 ? std::log(10.0) : -std::numeric_limits<double>::infinity();
        });
    }
};

struct BlueBlind : Importance {
    using Parameters = NoParameters;
    explicit BlueBlind(const Parameters&) {}
    double operator()(const Spectrum& f) const override { return f.x + f.y; }
};
struct Squared : Importance {
    using Parameters = NoParameters;
    explicit Squared(const Parameters&) {}
    double operator()(const Spectrum& f) const override { return f.x * f.x + f.y * f.y + f.z * f.z; }
};

template <class Type>
void addTarget(const char* name) {
    [[maybe_unused]] static const Registration<Importance, Type> registration(name, "for tests of the audit", __FILE__);
}
template <class Type>
void add(const char* name) {
    [[maybe_unused]] static const Registration<Mutation, Type> registration(name, "for tests of the audit", __FILE__);
}

}  // namespace

void registerAll() {
    add<Planted<Bug::None>>("planted_none");
    add<Planted<Bug::Geometry>>("planted_geometry");
    add<Planted<Bug::Swapped>>("planted_swapped");
    add<Planted<Bug::Blind>>("planted_blind");
    add<Planted<Bug::Geometry, false>>("planted_silent");
    add<Planted<Bug::Overfull>>("planted_overfull");
    add<Narrow>("planted_narrow");
    add<Nowhere>("planted_nowhere");
    add<Drift>("planted_drift");
    addTarget<BlueBlind>("planted_blueblind");
    addTarget<Squared>("planted_squared");
}

}  // namespace ulam::planted
