#pragma once
// A point of a Markov chain's space, a proposal, and the mutation interface (docs/mutations.md).

#include "core/config/registry.h"
#include "core/mcmc/statistics.h"
#include "core/path/factors.h"

#include <limits>
#include <optional>

namespace ulam {

/// The reference measure a density or a target belongs to: du on the unit cube, or product area measure dA of paths.
enum class Space : uint8_t { Primary, Path };

/// What one contribution adds to the image: a deposit is weight × value around a raster position.
struct Splat {
    Vec2f raster;
    Spectrum value;                ///< f / π of this part
    uint32_t feature;        ///< index of the last feature crossed before the camera, or kNone

    template <class Archive>
    void archive(Archive& a) {
        a(raster, value, feature);
    }

    Splat() {}  // left open: arrays of them are made often
    Splat(const Vec2f& where, const Spectrum& what, uint32_t label = kNone) : raster(where), value(what), feature(label) {}
};

/// Room for the light image's splats (t = 1) and the sample's own pixel.
class Splats {
public:
    Splats() : size_(0) {}
    Splats(const Splats& other) { *this = other; }
    Splats& operator=(const Splats& other) {
        size_ = other.size_;
        std::copy_n(other.splats_.begin(), size_, splats_.begin());
        return *this;
    }
    void clear() { size_ = 0; }
    void add(const Splat& s) { splats_[size_++] = s; }
    int size() const { return size_; }
    Splat& operator[](int i) { return splats_[i]; }
    const Splat& operator[](int i) const { return splats_[i]; }

    template <class Archive>
    void archive(Archive& a) {
        a(size_);
        for (int i = 0; i < size_; ++i) a(splats_[size_t(i)]);
    }

private:
    int size_;
    std::array<Splat, 2 * (kMaxDepth + 2)> splats_;
};

/// A point of the chain's space, and what the next step can reuse. Copies copy what is used.
struct Sample {
    Sample() {}

    /// What is used of it: two states are equal exactly if their bytes are.
    template <class Archive>
    void archive(Archive& a) {
        a(u, technique, path, factors, logDensity, logTarget, splats);
    }

    PrimaryVector u;       ///< empty if only the path is known
    Technique technique;   ///< that makes the path from u
    Path path;             ///< empty where the target sums over techniques
    PathFactors factors;   ///< of `path`
    double logDensity = 0; ///< log p_{s,t}(path); filled for Primary mutations on a Path target only
    double logTarget = -std::numeric_limits<double>::infinity();
    Splats splats;
};

struct Proposal {
    Sample y;
    double logForward = 0;   ///< log q(x → y), in the mutation's space
    double logReverse = 0;   ///< log q(y → x)
    double logJacobian = 0;  ///< of a deterministic or dimension-changing part
    Reject reject = Reject::None;

    Proposal() {}
    explicit Proposal(Reject reason) : reject(reason) {}
};

/// What a mutation works with: one chain's random numbers, rays, and the limits of the sampler.
struct StepContext {
    Random& random;
    Tracing& tracing;
    const PathLimits& limits;

    const Scene& scene() const { return tracing.scene(); }
};

/// Proposes a next state. It never decides: the kernel (kernel.h) does.
class Mutation {
public:
    static const char* kind() { return "mutation"; }
    /// Every mutation in a mix has a weight.
    static std::vector<std::string> commonKeys() { return {"weight"}; }
    virtual ~Mutation() = default;

    virtual Space space() const = 0;
    /// Is the proposal independent of the current state? (Kelemen's deposit weights treat such steps apart.)
    virtual bool isLargeStep() const { return false; }
    /// Unnormalised; depends on the current state alone. 0: cannot be applied.
    virtual double suitability(const Sample&) const { return 1; }
    /// Primary: fills y.u. Path: fills y.path and y.factors; y's target is evaluated by the kernel.
    virtual Proposal propose(const Sample& x, StepContext& context) const = 0;
    /// log q(from → to) computed afresh, for the audit and for kernels that need it.
    virtual std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext& context) const {
        (void)from, (void)to, (void)context;
        return std::nullopt;
    }
};

}  // namespace ulam

#define ULAM_REGISTER_MUTATION(Type, name, summary) ULAM_REGISTER(::ulam::Mutation, Type, name, summary)
