#include "core/mcmc/audit/number_map.h"

#include <optional>

#include "core/mcmc/audit/subject.h"

namespace ulam::audit {
namespace {

// Widths of the central differences, largest first: the error of the wider ones is O(h⁴), but they reach beyond edges.
constexpr std::array kWidths{1.6e-2, 4e-3, 1e-3, 2.5e-4};
// Disagreement of the fourth-order difference and that of its outer two paths, in log |J|, beyond which a branch is
// left out: rounding shows in it as well as curvature.
constexpr double kNoise = 0.01;
constexpr int kBisections = 34;
constexpr int kGrid = 8, kTries = 48;
constexpr size_t kFurtherBlocks = 8;  // that another choice may use

using Column = std::vector<double>;  // derivatives of all coordinates by one number, two a vertex

/// The same vertices, bit by bit.
bool same(const Vertex& a, const Vertex& b) {
    return a.kind == b.kind && a.shape == b.shape && a.lobe == b.lobe && a.position == b.position;
}
bool same(const Path& a, const Path& b) {
    if (a.size() != b.size()) return false;
    for (int i = 0; i < a.size(); ++i)
        if (!same(a[i], b[i])) return false;
    return true;
}
/// The same surfaces and lobes. Another triangle would be another slope: a difference across an edge is no derivative.
bool comparable(const Path& a, const Path& b) {
    if (a.size() != b.size()) return false;
    for (int i = 0; i < a.size(); ++i)
        if (a[i].kind != b[i].kind || a[i].shape != b[i].shape || a[i].lobe != b[i].lobe ||
            (a[i].onSurface() && a[i].primitive != b[i].primitive))
            return false;
    return true;
}

/// log |det| by elimination with pivots; −∞ where singular.
double logDeterminant(std::vector<Column> m) {
    double sum = 0;
    const size_t n = m.size();
    for (size_t i = 0; i < n; ++i) {
        size_t pivot = i;
        for (size_t r = i + 1; r < n; ++r)
            if (std::abs(m[r][i]) > std::abs(m[pivot][i])) pivot = r;
        std::swap(m[i], m[pivot]);
        sum += std::log(std::abs(m[i][i]));
        for (size_t r = i + 1; r < n; ++r) {
            const double factor = m[r][i] / m[i][i];
            for (size_t c = i; c < n; ++c) m[r][c] -= factor * m[i][c];
        }
    }
    return sum;
}

class Displacement {
public:
    Displacement(const NumberMap& map, std::span<const Block> numbers, const Scene& scene, const Path& origin,
                 const Path& path, const PathFactors& factors)
        : map_(map), numbers_(numbers.begin(), numbers.end()), scene_(scene), path_(path), factors_(factors) {
        const int shift = path.size() - origin.size();
        for (int i = 0; i < path.size(); ++i) {
            const auto keptAs = [&](int j) {
                return j >= 0 && j < origin.size() && path[i].position == origin[j].position &&
                       path[i].shape == origin[j].shape;
            };
            made_[size_t(i)] = !keptAs(i) && !keptAs(i - shift);
        }
    }

    Branch run(Random& alternatives) {
        Branch branch;
        // A width that reaches beyond the interval of a choice mistakes it for a number that moves the path.
        for (size_t widest = 0; widest < kWidths.size() && branch.outcome != Branch::Outcome::Resolved; ++widest)
            tryWidths(widest, branch);
        if (branch.outcome == Branch::Outcome::Resolved) {
            takeChoices(branch);
            branch.only = isOnlyBranch(alternatives);
        }
        return branch;
    }

private:
    /// Everything but the choices' probability, from differences of no more than a width.
    void tryWidths(size_t widest, Branch& branch) {
        branch = {};
        choices_.clear(), movers_.clear(), secondOrder_.clear(), fourthOrder_.clear();
        for (size_t n = 0; n < 4 * numbers_.size(); ++n)
            if (!displace(n, widest)) return;
        const auto split = findSplit();
        if (!split) {
            branch.outcome = Branch::Outcome::NotSquare;
            return;
        }
        const double fine = logDeterminant(jacobian(*split, fourthOrder_)),
                     coarse = logDeterminant(jacobian(*split, secondOrder_));
        if (!(std::abs(fine - coarse) < kNoise)) return;
        branch.outcome = Branch::Outcome::Resolved;
        branch.logDensity = -fine;
        for (int i = 0; i < path_.size(); ++i) {
            const bool placed = isMade(i) && !isFree(i, *split);
            if (placed) branch.logDensity += std::log(deltaFactor(i, *split));
            branch.moved += placed ? '+' : isMade(i) ? '*' : '.';
        }
    }

    void takeChoices(Branch& branch) {
        std::vector<size_t> unused;
        for (size_t n : choices_) {
            const double p = probability(n);
            branch.logDensity += std::log(p);
            if (p == 1) unused.push_back(n);
        }
        std::erase_if(choices_, [&](size_t n) { return std::find(unused.begin(), unused.end(), n) != unused.end(); });
    }

    double& number(size_t n) { return numbers_[n / 4][n % 4]; }

    /// The path with number n at another value.
    bool at(size_t n, double value, Path& out) {
        const double old = std::exchange(number(n), value);
        PathFactors unused;
        const bool made = map_(numbers_, out, unused);
        number(n) = old;
        return made;
    }
    bool leaves(size_t n, double value) {
        Path other;
        return at(n, value, other) && same(other, path_);
    }

    /// Finds out whether number n moves the path, and how. False where that cannot be said.
    bool displace(size_t n, size_t widest) {
        const double u = number(n);
        for (size_t w = widest; w < kWidths.size(); ++w) {
            const double h = std::min({kWidths[w], 0.4 * u, 0.4 * (1 - u)});
            std::array<Path, 4> p;
            const std::array steps{-2 * h, -h, h, 2 * h};
            bool good = true, moved = false;
            for (size_t i = 0; i < 4 && good; ++i) {
                good = at(n, u + steps[i], p[i]) && comparable(p[i], path_);
                moved = moved || (good && !same(p[i], path_));
            }
            if (!good) continue;
            if (!moved) return choices_.push_back(n), true;
            Column second, fourth;
            for (int i = 0; i < path_.size(); ++i) {
                const auto [a, b] = tangents(path_[i]);
                for (const Vec3d& axis : {a, b}) {
                    const auto x = [&](size_t k) {
                        return (Vec3d(p[k][i].position) - Vec3d(path_[i].position)).dot(axis);
                    };
                    second.push_back((x(3) - x(0)) / (4 * h));
                    fourth.push_back((8 * (x(2) - x(1)) - (x(3) - x(0))) / (12 * h));
                }
            }
            secondOrder_.push_back(std::move(second));
            fourthOrder_.push_back(std::move(fourth));
            movers_.push_back(n);
            return true;
        }
        return false;
    }

    static std::pair<Vec3d, Vec3d> tangents(const Vertex& v) {
        const Frame frame(v.hasNormal() ? v.normal : v.atInfinity() ? v.position : Vec3f(0, 0, 1));
        return {Vec3d(frame.s), Vec3d(frame.t)};
    }

    /// Has coordinates that the numbers or a delta lobe chose? Pinholes and delta lights have none.
    bool isMade(int i) const { return path_[i].kind != Vertex::Kind::Point && path_[i].kind != Vertex::Kind::Direction && made_[size_t(i)]; }

    /// The length of the interval around number n in which the path stays.
    double probability(size_t n) {
        const auto edge = [&](double inside, double outside) {
            if (leaves(n, outside)) return outside;
            for (int i = 0; i < kBisections; ++i) {
                const double middle = (inside + outside) / 2;
                (leaves(n, middle) ? inside : outside) = middle;
            }
            return inside;
        };
        const double u = number(n);
        return edge(u, 1 - 0x1p-33) - edge(u, 0x1p-33) + 0x1p-32;
    }

    /// Which vertices are free depends on the end that a path is made from. Any s vertices from the light will do whose
    /// free ones are as many as the numbers: the measure is the same.
    bool isFree(int i, int s) const {
        if (i < s) return i == 0 || !isDelta(path_[i - 1].lobe);
        return i == path_.length() || !isDelta(path_[i + 1].lobe);
    }
    std::optional<int> findSplit() const {
        for (int s = 0; s <= path_.length(); ++s) {
            if (s > 0 && !connectable(path_[s - 1], path_[s])) continue;
            size_t coordinates = 0;
            for (int i = 0; i < path_.size(); ++i) coordinates += 2 * (isMade(i) && isFree(i, s));
            if (coordinates == movers_.size()) return s;
        }
        return std::nullopt;
    }
    std::vector<Column> jacobian(int split, const std::vector<Column>& columns) const {
        std::vector<Column> square;
        for (const Column& c : columns) {
            square.emplace_back();
            for (int i = 0; i < path_.size(); ++i)
                if (isMade(i) && isFree(i, split))
                    square.back().insert(square.back().end(), {c[size_t(2 * i)], c[size_t(2 * i + 1)]});
        }
        return square;
    }
    /// The density with which the delta lobe beside x_i places it, its choice aside.
    double deltaFactor(int i, int split) const {
        const bool fromLight = i < split;
        const int at = fromLight ? i - 1 : i + 1;
        const Vec3f toLight = -factors_.edge[size_t(at - 1)].direction, toCamera = factors_.edge[size_t(at)].direction;
        const double choice = fromLight ? lobeProbability(scene_, path_[at], toLight, toCamera)
                                        : lobeProbability(scene_, path_[at], toCamera, toLight);
        return (fromLight ? factors_.fromLight(i) : factors_.fromCamera(i)) / choice;
    }

    /// Looks for other values of the choices with which a path of the same shape and the same kept vertices comes
    /// about.
    bool isOnlyBranch(Random& random) {
        for (size_t n : choices_)
            for (int g = 0; g < kGrid; ++g) {
                const double value = (g + 0.5) / kGrid;
                if (!leaves(n, value) && hasBranch(n, value, random)) return false;
            }
        return true;
    }
    /// Where no path comes about at all, there may be one. A long path of a rare shape does not come about by chance:
    /// every other attempt draws only the numbers that are used together with the choice, and keeps the rest of the path.
    bool hasBranch(size_t n, double value, Random& random) {
        const std::vector<Block> original = numbers_;
        Path other;
        PathFactors unused;
        bool made = false, found = false;
        for (int attempt = 0; attempt < kTries && !found; ++attempt) {
            for (size_t m = 0; m < 4 * original.size(); ++m) {
                const bool drawn = attempt % 2 != 0 || m / 4 == n / 4;
                if (drawn && std::find(choices_.begin(), choices_.end(), m) == choices_.end()) number(m) = random();
            }
            number(n) = value;
            for (size_t b = 0; b < kFurtherBlocks; ++b) numbers_.push_back(random.nextBlock());
            if (map_(numbers_, other, unused)) made = true, found = couldBe(other);
            numbers_ = original;
        }
        return found || !made;
    }
    bool couldBe(const Path& other) const {
        if (other.size() != path_.size()) return false;
        for (int i = 0; i < path_.size(); ++i) {
            if (!isMade(i) && !same(other[i], path_[i])) return false;
            if (other[i].lobe != path_[i].lobe) return false;
        }
        return true;
    }

    const NumberMap& map_;
    std::vector<Block> numbers_;
    const Scene& scene_;
    const Path& path_;
    const PathFactors& factors_;
    std::array<bool, kMaxVertices> made_{};
    std::vector<size_t> choices_, movers_;           // numbers that do not move the path, and that do
    std::vector<Column> secondOrder_, fourthOrder_;  // by mover
};

}  // namespace

Branch findBranch(const NumberMap& map, std::span<const Block> numbers, const Scene& scene, const Path& origin,
                  const Path& path, const PathFactors& factors, Random alternatives) {
    return Displacement(map, numbers, scene, origin, path, factors).run(alternatives);
}

}  // namespace ulam::audit
