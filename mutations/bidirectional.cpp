// bidirectional: deletes a subpath and grows a new one from both ends (Veach 1997, §11.4.2).
//
// x_l and x_m are the vertices kept next to the deleted edges, −1 ≤ l < m ≤ k+1; with l = −1 the light's end goes too,
// with m = k+1 the camera's. Of the `added` edges, l' vertices are grown from x_l, m' from x_m, and one edge joins them.
// Many (l', m') give the same new path: the density of a proposal is the sum over all of them.

#include "core/mcmc/path_edit.h"

namespace ulam {
namespace {

class Bidirectional : public Mutation {
public:
    struct Parameters {
        double sameLength = 0.5, nextLength = 0.15;
        template <class V>
        void describe(V& v) {
            v("same_length", sameLength, {.help = "weight of adding as many edges as were deleted", .min = 0, .max = 1});
            v("next_length", nextLength, {.help = "weight of adding one edge more, and of one fewer; the rest goes to larger changes, halving each time", .min = 0, .max = 0.5});
        }
    };
    explicit Bidirectional(const Parameters& p) : parameters_(p) {
        if (p.sameLength + 2 * p.nextLength > 1) fail(ExitCode::InvalidConfig, "bidirectional: same_length + 2 next_length is {}, more than 1", p.sameLength + 2 * p.nextLength);
    }

    Space space() const override { return Space::Path; }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        Random& random = context.random;
        const int k = x.path.length();
        int l = -1, m = 0;
        const Deletions deletions(context.scene(), x);
        if (!deletions.choose(random, l, m)) {
            p.reject = Reject::ZeroTarget;
            return p;
        }
        const int deleted = m - l;
        const Range range(x.path, l, m, context);
        const int added = chooseAddition(deleted, k, context.limits.maxDepth, random());
        if (added == 0) {
            p.reject = Reject::ZeroTarget;
            return p;
        }

        // Which ways of sharing the new vertices out are possible depends on what both paths have in common only.
        const int fewest = range.fewestFromLight(), most = added - 1 - range.fewestFromCamera();
        if (most < fewest) {
            p.reject = Reject::ZeroTarget;
            return p;
        }
        const int fromLight = fewest + random.index(most - fewest + 1), fromCamera = added - 1 - fromLight;

        PathEdit edit(x, l, m, added, context, p.y);
        for (int i = 0; i < fromCamera; ++i)
            if ((p.reject = edit.growFromCamera(random.nextBlock())) != Reject::None) return p;
        for (int i = 0; i < fromLight; ++i)
            if ((p.reject = edit.growFromLight(random.nextBlock(), l < 0 && fromLight == 1)) != Reject::None) return p;
        // A delta lobe or a point light may put a vertex back where it was: that is a smaller change, and as such proposed
        // elsewhere. So every new path is made by one (l, m) only.
        if (added > 1 && ((l >= 0 && same(p.y.path[l + 1], x.path[l + 1])) || (m > 0 && m <= k && same(p.y.path[l + added - 1], x.path[m - 1])))) {
            p.reject = Reject::NotInvertible;
            return p;
        }
        if ((p.reject = edit.join()) != Reject::None) return p;

        p.logForward = deletions.logProbability(l, m) + logAddition(added, deleted, k, context.limits.maxDepth) +
                       range.logSubpath(p.y.path, p.y.factors, added);
        const int kY = p.y.path.length();
        p.logReverse = Deletions(context.scene(), p.y).logProbability(l, l + added) + logAddition(deleted, added, kY, context.limits.maxDepth) +
                       range.logSubpath(x.path, x.factors, deleted);
        return p;
    }

    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext& context) const override {
        // Which vertices are common decides what was deleted; a vertex grown anew coincides with an old one with
        // probability zero, so there is one (l, m).
        const int k = from.path.length(), kY = to.path.length(), shift = kY - k;
        const Deletions deletions(context.scene(), from);
        int l = -1, m = deletions.largestM();
        while (l + 1 < std::min(k, kY) && same(from.path[l + 1], to.path[l + 1])) ++l;
        if (l == 0 && !hittable(from.path.light())) l = -1;
        while (m - 1 > l && m - 1 + shift > l && same(from.path[m - 1], to.path[m - 1 + shift])) --m;
        const Range range(from.path, l, m, context);
        return deletions.logProbability(l, m) + logAddition(m + shift - l, m - l, k, context.limits.maxDepth) +
               range.logSubpath(to.path, to.factors, m + shift - l);
    }

private:
    static bool same(const Vertex& a, const Vertex& b) { return a.position == b.position && a.kind == b.kind && a.shape == b.shape; }

    /// What the old and the new path have in common: the kept ends.
    struct Range {
        Range(const Path& x, int lightEnd, int cameraEnd, const StepContext& stepContext) : l(lightEnd), context(stepContext) {
            // A new path may end on a light hit by chance, but not on a lens.
            joinableL = l <= 0 || smooth(x[l]);
            joinableM = cameraEnd <= x.length() && (cameraEnd == x.length() || smooth(x[cameraEnd]));
        }
        int fewestFromLight() const { return joinableL ? 0 : 1; }
        int fewestFromCamera() const { return joinableM ? 0 : 1; }

        /// log Σ over the ways to share out the new vertices of their density in `path`, which has `edges` between the ends.
        double logSubpath(const Path& path, const PathFactors& f, int edges) const {
            const Scene& scene = context.scene();
            const int k = path.length();
            const int fewest = fewestFromLight(), most = edges - 1 - fewestFromCamera();
            // Extended range: products over long paths leave the range of double.
            long double sum = 0, camera = 1;
            std::array<long double, kMaxVertices + 1> light;
            light[0] = 1;
            for (int n = 1; n < edges; ++n) light[size_t(n)] = light[size_t(n - 1)] * (l + n == 0 ? emissionPositionPdf(scene, path[0]) : f.fromLight(l + n));
            for (int n = edges - 1; n >= 0; --n) {  // n vertices from the light
                if (n >= fewest && n <= most && joinable(path, l + n)) {
                    const long double fromLight = l < 0 && n == 1 ? directLightPdf(scene, path[1], path[0]) : light[size_t(n)];
                    sum += fromLight * camera;
                }
                if (n > 0) camera *= l + n == k ? scene.sensor->positionPdf(path[k]) : f.fromCamera(l + n);
            }
            return double(std::log(sum)) - std::log(double(most - fewest + 1));
        }

        /// Can the edge after vertex i be the joining one?
        static bool joinable(const Path& path, int i) { return i < 0 ? hittable(path[0]) : connectable(path[i], path[i + 1]); }
        bool smooth(const Vertex& v) const {
            return !v.onSurface() || context.scene().materialAt(v).hasSmooth;
        }

        int l;
        bool joinableL, joinableM;
        const StepContext& context;
    };

    /// Where subpaths can be deleted, and how likely each is. An end at a given point (a pinhole, a point light) would be
    /// grown anew in the same place: such a lens is always kept, such a light always goes with the edge behind it, so
    /// that every new path is made by one (l, m) only.
    ///
    /// p_d = p_d1(deleted edges) · p_d2(l, m). p_d2 estimates the acceptance, α = C(y)/C(x) with C = contribution over
    /// density of what lies between x_l and x_m: C(x) is known; for C(y), which is not, stands the harmonic mean of C over
    /// the subpaths of x with as many edges. Subpaths at either end, whose C is of another magnitude, have p_d2 = 1.
    class Deletions {
    public:
        Deletions(const Scene& scene, const Sample& x) : k_(x.path.length()), largestM_(scene.sensor->positionIsDelta() ? k_ : k_ + 1) {
            const Path& path = x.path;
            const PathFactors& f = x.factors;
            std::array<double, kMaxVertices> value;
            for (int i = 0; i <= k_; ++i) value[size_t(i)] = luminance(f.at[size_t(i)].f);
            std::array<double, kMaxVertices + 2> sum{};
            std::array<int, kMaxVertices + 2> count{};
            for (int l = -1; l < k_; ++l) {
                if (l == 0 && !hittable(path.light())) continue;
                // Between x_l and x_m: the contribution, the density if all is grown from the light, and summed over
                // all ways to share the vertices out.
                double contribution = l < 0 ? 1 : value[size_t(l)], fromLight = 1, density = 0;
                for (int m = l + 1; m <= largestM_; ++m) {
                    if (m <= k_) contribution *= value[size_t(m)] * (m > 0 ? f.edge[size_t(m - 1)].geometry() : 1);
                    if (m > l + 1) {
                        const int grown = m - 1;
                        density *= grown == k_ ? scene.sensor->positionPdf(path[k_]) : f.fromCamera(grown);
                        fromLight *= grown == 0 ? emissionPositionPdf(scene, path[0]) : f.fromLight(grown);
                    }
                    if (m <= k_ && (m == 0 ? hittable(path[0]) : connectable(path[m - 1], path[m]))) density += fromLight;
                    const double ease = density / contribution;
                    ease_[size_t(l + 1)][size_t(m)] = ease;
                    if (inner(l, m)) {
                        sum[size_t(m - l)] += ease;
                        ++count[size_t(m - l)];
                    }
                }
            }
            for (int l = -1; l < k_; ++l) {
                if (l == 0 && !hittable(path.light())) continue;
                for (int m = l + 1; m <= largestM_; ++m) {
                    double& weight = ease_[size_t(l + 1)][size_t(m)];
                    if (!(weight > 0)) continue;
                    const size_t edges = size_t(m - l);
                    weight = lengthWeight(m - l) * (inner(l, m) ? std::min(1.0, weight * count[edges] / sum[edges]) : 1);
                    total_ += weight;
                }
            }
            pointLight_ = !hittable(path.light());
        }

        /// False where nothing can be deleted.
        bool choose(Random& random, int& l, int& m) const {
            double u = random() * total_;
            for (int i = -1; i < k_; ++i) {
                if (i == 0 && pointLight_) continue;
                for (int j = i + 1; j <= largestM_; ++j) {
                    const double weight = ease_[size_t(i + 1)][size_t(j)];
                    if (weight > 0) l = i, m = j;
                    if ((u -= weight) < 0) return true;
                }
            }
            return total_ > 0;
        }
        double logProbability(int l, int m) const { return std::log(ease_[size_t(l + 1)][size_t(m)] / total_); }
        int largestM() const { return largestM_; }

    private:
        /// p_d1: ¼ for one deleted edge, ½ for two, 2^−n for more.
        static double lengthWeight(int edges) { return edges == 1 ? 0.25 : edges == 2 ? 0.5 : halved(edges); }
        bool inner(int l, int m) const { return l > 0 && m < k_; }

        int k_, largestM_;
        bool pointLight_ = false;
        double total_ = 0;
        std::array<std::array<double, kMaxVertices + 1>, kMaxVertices> ease_;
    };

    /// p_a: weight of `added` edges in the place of `deleted`; nothing for one new edge in the place of one.
    double additionWeight(int added, int deleted) const {
        if (added == 1 && deleted == 1) return 0;
        const int change = std::abs(added - deleted);
        if (change == 0) return parameters_.sameLength;
        if (change == 1) return parameters_.nextLength;
        return (1 - parameters_.sameLength - 2 * parameters_.nextLength) * halved(change);
    }
    /// The new path must have between one edge and maxDepth.
    static int fewestAdded(int deleted, int k) { return std::max(1, deleted - k + 1); }
    static int mostAdded(int deleted, int k, int maxDepth) { return maxDepth - k + deleted; }

    double additionTotal(int deleted, int k, int maxDepth) const {
        double total = 0;
        for (int n = fewestAdded(deleted, k); n <= mostAdded(deleted, k, maxDepth); ++n) total += additionWeight(n, deleted);
        return total;
    }
    int chooseAddition(int deleted, int k, int maxDepth, double random) const {
        double u = random * additionTotal(deleted, k, maxDepth);
        int chosen = 0;
        for (int n = fewestAdded(deleted, k); n <= mostAdded(deleted, k, maxDepth); ++n) {
            const double weight = additionWeight(n, deleted);
            if (weight > 0) chosen = n;
            if ((u -= weight) < 0) break;
        }
        return chosen;
    }
    double logAddition(int added, int deleted, int k, int maxDepth) const {
        return std::log(additionWeight(added, deleted) / additionTotal(deleted, k, maxDepth));
    }

    /// 2^−n
    static double halved(int n) { return 1 / double(uint64_t(1) << n); }

    Parameters parameters_;
};

ULAM_REGISTER_MUTATION(Bidirectional, "bidirectional", "deletes a subpath and grows another from both its ends");

}  // namespace
}  // namespace ulam
