#include "core/mcmc/audit/density.h"

#include <map>

#include "core/mcmc/audit/guide.h"
#include "core/mcmc/small_steps.h"

namespace ulam::audit {
namespace {

/// Share of the tries that go to the pilot, what a class needs of them, and how many classes of a state are tested.
constexpr double kPilotShare = 0.3, kFewestShare = 0.04;
constexpr size_t kMostClasses = 2;
// Pilot proposals that are kept as values.
constexpr size_t kMostKept = 2000;
/// Smallest effective share of the guide's samples: in many dimensions few of them can carry all the weight, and their
/// mean is no estimate then.
constexpr double kFewestEffective = 0.1;
/// How often a number of the guide is uniform.
constexpr double kUniformShare = 0.02;

class OfPaths {
public:
    OfPaths(const AuditScene& scene, const Subject& subject, const Sample& x, RandomKey key, uint64_t index)
        : scene_(scene), subject_(subject), x_(x), key_(key), index_(index), target_(subject.makeTarget(scene)) {}

    DensityTally run(uint64_t proposals) {
        const auto pilots = uint64_t(double(proposals) * kPilotShare);
        std::map<ProposalClass, std::vector<Sample>> found;
        Sample y;
        for (uint64_t i = 0; i < pilots; ++i) {
            if (!propose(i, y)) continue;
            auto& kept = found[ProposalClass(x_.path, y.path)];
            if (kept.size() < kMostKept) kept.push_back(y);
        }
        std::vector<const std::pair<const ProposalClass, std::vector<Sample>>*> frequent;
        for (const auto& entry : found)
            if (entry.first.grown() > 0 && double(entry.second.size()) >= kFewestShare * double(std::min<uint64_t>(pilots, kMostKept)))
                frequent.push_back(&entry);
        std::stable_sort(frequent.begin(), frequent.end(), [](auto* a, auto* b) { return a->second.size() > b->second.size(); });

        struct Tested {
            ProposalClass c;
            PathGuide guide;
            MarginalTest test;
        };
        std::vector<Tested> tested;
        for (const auto* entry : frequent) {
            if (tested.size() == kMostClasses) break;
            PathGuide guide(scene_, x_, entry->first, entry->second);
            if (!guide.possible()) continue;
            std::vector<Coordinates> rows;
            for (const Sample& s : entry->second)
                if (guide.covers(s)) rows.push_back(coordinates(entry->first, s));
            if (rows.empty()) continue;
            tested.push_back({entry->first, std::move(guide), MarginalTest(names(entry->first, entry->second.front().path), rows)});
        }
        tally_.states = 1;
        if (tested.empty()) {
            ++tally_.unjudged;
            return tally_;
        }
        for (uint64_t i = pilots; i < pilots + proposals; ++i) {
            if (!propose(i, y)) continue;
            const ProposalClass c(x_.path, y.path);
            for (Tested& t : tested)
                if (t.c == c && t.guide.covers(y)) t.test.observe(coordinates(c, y));
        }
        double mass = 0, variance = 0;
        for (Tested& t : tested) {
            for (uint64_t i = 0; i < proposals; ++i)
                if (!expect(t.c, t.guide, i, t.test)) return tally_;
            DensityTest result{fmt::format("{} → {}", pathClass(x_.path), describe(t.c)), index_, proposals, proposals, t.test.finish(proposals, proposals)};
            mass += result.marginals[0].expected[0], variance += result.marginals[0].error[0] * result.marginals[0].error[0];
            tally_.tests.push_back(std::move(result));
        }
        if (mass - kMassErrors * std::sqrt(variance) > 1)
            tally_.failures.add(index_, fmt::format("exp(log q) integrates to {:.4g} ± {:.2g} (state {})", mass, std::sqrt(variance), pathClass(x_.path)));
        return tally_;
    }

private:
    bool propose(uint64_t i, Sample& y) {
        Random random = randomOf(key_, Stream::Density, index_ << 32 | i);
        StepContext context{random, target_->tracing(), scene_.limits};
        Proposal p = subject_.mutation().propose(x_, context);
        if (p.reject != Reject::None || target_->evaluatePath(p.y) != Reject::None) return false;
        y = p.y;
        return true;
    }

    /// False if the mutation has no density.
    bool expect(const ProposalClass& c, const PathGuide& guide, uint64_t i, MarginalTest& test) {
        Random random = randomOf(key_, Stream::Guide, index_ << 32 | i);
        StepContext context{random, target_->tracing(), scene_.limits};
        Sample y;
        if (!guide.sample(context, random, y) || target_->evaluatePath(y) != Reject::None || !(ProposalClass(x_.path, y.path) == c) || !guide.covers(y)) return true;
        const auto q = subject_.mutation().logDensity(x_, y, context);
        if (!q) return tally_.hasDensity = false;
        const double weight = std::exp(*q - guide.logDensity(y));
        if (weight > 0) test.expect(coordinates(c, y), weight);
        return true;
    }

    static constexpr int kMostVertices = 2;
    /// The new vertices of y that have coordinates: at most so many from the camera's side.
    static std::vector<int> placed(const ProposalClass& c, const Path& y) {
        std::vector<int> vertices;
        for (int i = c.kept + c.added - 1; i > c.kept && vertices.size() < kMostVertices; --i)
            if (i < y.length()) vertices.push_back(i);
        return vertices;
    }
    std::vector<std::string> names(const ProposalClass& c, const Path& y) const {
        std::vector<std::string> names{"raster x", "raster y", "log10 raster step"};
        for (const int i : placed(c, y)) {
            for (const char* axis : {"x", "y", "z"}) names.push_back(fmt::format("{} of vertex {}", axis, i));
            if (old(c, i) >= 0) names.push_back(fmt::format("log10 way of vertex {}", i));
        }
        return names;
    }
    Coordinates coordinates(const ProposalClass& c, const Sample& y) const {
        const Vec2f r = y.splats[0].raster, d = r - x_.splats[0].raster;
        Coordinates row{r.x, r.y, std::log10(std::max(1e-6, double(d.length())))};
        for (const int i : placed(c, y.path)) {
            const Vec3f& p = y.path[i].position;
            row.insert(row.end(), {p.x, p.y, p.z});
            if (old(c, i) >= 0) row.push_back(std::log10(std::max(1e-6, double(length(p - x_.path[old(c, i)].position)))));
        }
        return row;
    }
    /// The vertex of x in the place of y_i, counted from the camera.
    int old(const ProposalClass& c, int i) const { return i - (c.kept + c.added - c.first); }

    static std::string describe(const ProposalClass& c) {
        return fmt::format("x0…x{} kept, {} new edges {}, kept from x{}", c.kept, c.added, c.lobes, c.first);
    }

    const AuditScene& scene_;
    const Subject& subject_;
    const Sample& x_;
    RandomKey key_;
    uint64_t index_;
    std::unique_ptr<Target> target_;
    DensityTally tally_;
};

/// Displacements of single numbers. The guide draws each by itself.
class OfNumbers {
public:
    OfNumbers(const AuditScene& scene, const Subject& subject, const Sample& state, RandomKey key, uint64_t index)
        : scene_(scene), subject_(subject), x_(state), key_(key), index_(index), target_(subject.makeTarget(scene)) {}

    DensityTally run(uint64_t proposals) {
        tally_.states = 1;
        if (subject_.target() == Space::Path) {
            Random random = randomOf(key_, Stream::Guide, index_ << 32);
            if (!std::isfinite(target_->redrawTechnique(x_, random, true))) {
                ++tally_.unjudged;
                return tally_;
            }
        }
        std::vector<std::string> names;
        for (int s = 0; s < kStreams; ++s)
            for (int i = 0; i < x_.u.size(NumberStream(s)); ++i)
                for (int j = 0; j < 4; ++j)
                    names.push_back(fmt::format("step of {} number {}.{}", std::array{"light", "camera", "connection"}[size_t(s)], i, j));
        const size_t numbers = names.size();
        names.push_back("largest step");

        const uint64_t pilots = proposals;  // they are cheap, and the guide draws many numbers
        std::vector<Coordinates> pilot;
        Sample y = x_;
        for (uint64_t i = 0; i < pilots; ++i)
            if (propose(i, y)) pilot.push_back(coordinates(y));
        if (double(pilot.size()) < kFewestShare * double(pilots)) {
            ++tally_.unjudged;
            return tally_;
        }
        for (size_t n = 0; n < numbers; ++n) {
            std::vector<double> steps;
            for (const Coordinates& row : pilot) steps.push_back(std::abs(row[n]));
            guide_.emplace_back(std::move(steps), 0.5);
        }
        MarginalTest test(names, pilot);
        for (uint64_t i = pilots; i < pilots + proposals; ++i)
            if (propose(i, y)) test.observe(coordinates(y));
        for (uint64_t i = 1; i <= proposals; ++i) {
            Random random = randomOf(key_, Stream::Guide, index_ << 32 | i);
            StepContext context{random, target_->tracing(), scene_.limits};
            const double logGuide = guided(random, y);
            const auto q = subject_.mutation().logDensity(x_, y, context);
            if (!q) {
                tally_.hasDensity = false;
                return tally_;
            }
            const double weight = std::exp(*q - logGuide);
            if (weight > 0) test.expect(coordinates(y), weight);
        }
        DensityTest result{fmt::format("{} numbers of {}", numbers, pathClass(x_.path)), index_, proposals, proposals, test.finish(proposals, proposals)};
        const Marginal& mass = result.marginals[0];
        const double relative = mass.error[0] / mass.expected[0];
        if (!(double(proposals) * (1 + double(proposals) * relative * relative) < double(proposals) / kFewestEffective)) {
            ++tally_.unjudged;
            return tally_;
        }
        if (mass.expected[0] - kMassErrors * mass.error[0] > 1)
            tally_.failures.add(index_, fmt::format("exp(log q) integrates to {:.4g} ± {:.2g}", mass.expected[0], mass.error[0]));
        tally_.tests.push_back(std::move(result));
        return tally_;
    }

private:
    bool propose(uint64_t i, Sample& y) {
        Random random = randomOf(key_, Stream::Density, index_ << 32 | i);
        StepContext context{random, target_->tracing(), scene_.limits};
        Proposal p = subject_.mutation().propose(x_, context);
        if (p.reject != Reject::None) return false;
        // What the mutation leaves open is uniform.
        for (int s = 0; s < kStreams; ++s)
            while (p.y.u.size(NumberStream(s)) < x_.u.size(NumberStream(s))) p.y.u.append(NumberStream(s), random.nextBlock());
        y.u = p.y.u;
        return true;
    }

    template <class Visit>
    void forEach(Sample& y, Visit&& visit) const {
        size_t n = 0;
        for (int s = 0; s < kStreams; ++s)
            for (int i = 0; i < x_.u.size(NumberStream(s)); ++i)
                for (size_t j = 0; j < 4; ++j) visit(n++, x_.u(NumberStream(s), i)[j], y.u(NumberStream(s), i)[j]);
    }

    Coordinates coordinates(Sample& y) const {
        Coordinates row;
        double largest = 0;
        forEach(y, [&](size_t, double from, double to) {
            row.push_back(wrappedDifference(from, to));
            largest = std::max(largest, std::abs(row.back()));
        });
        row.push_back(largest);
        return row;
    }

    double logOfStep(size_t n, double step) const {
        return std::log(kUniformShare + (1 - kUniformShare) * guide_[n].pdf(std::abs(step)) / 2);
    }
    double guided(Random& random, Sample& y) const {
        double sum = 0;
        y.u = x_.u;
        forEach(y, [&](size_t n, double from, double& to) {
            const double choice = random(), u = random(), sign = random() < 0.5 ? -1 : 1;
            double step = choice < kUniformShare || guide_[n].empty() ? u - 0.5 : sign * guide_[n].sample(u);
            step -= std::floor(step + 0.5);
            to = wrapped(from, step);
            sum += logOfStep(n, step);
        });
        return sum;
    }

    const AuditScene& scene_;
    const Subject& subject_;
    Sample x_;
    RandomKey key_;
    uint64_t index_;
    std::unique_ptr<Target> target_;
    std::vector<PilotLength> guide_;
    DensityTally tally_;
};

}  // namespace

void DensityTally::merge(const DensityTally& later) {
    states += later.states, unjudged += later.unjudged;
    hasDensity = hasDensity && later.hasDensity;
    tests.insert(tests.end(), later.tests.begin(), later.tests.end());
    failures.merge(later.failures);
}

DensityTally auditDensity(const AuditScene& scene, const Subject& subject, const Sample& state, RandomKey key,
                          uint64_t index, uint64_t proposals) {
    return subject.mutation().space() == Space::Path ? OfPaths(scene, subject, state, key, index).run(proposals)
                                                     : OfNumbers(scene, subject, state, key, index).run(proposals);
}

}  // namespace ulam::audit
