#include "core/mcmc/audit/enumeration.h"

#include <cmath>

#include "core/mcmc/audit/scenes.h"
#include "core/mcmc/kernel.h"

namespace ulam::audit {
namespace {

constexpr int kStates = 6, kCells = 8, kTechniques = 2;
// Probabilities are multiples of 1/60 (which mutation), 1/2 (which numbers make a state) or 1/8 (all others).
constexpr int kSelections = 60, kInversions = 2, kChoices = 8;

/// π as a density with respect to a measure that differs from state to state. The last state is dark.
constexpr std::array<double, kStates> kDensity{0.7, 2.1, 0.35, 1.3, 0.9, 0}, kMeasure{1, 0.5, 3, 0.8, 1.7, 2};
constexpr std::array<double, kCells> kCellDensity{0.4, 1.9, 0, 0.75, 1.1, 0.2, 2.6, 0.9};

/// The state that a technique makes of a cell of the numbers; each state's cells are one or two.
constexpr int kMade[kTechniques][kCells] = {{0, 0, 1, 2, 2, 3, 4, 5}, {1, 0, 3, 3, 4, 2, 1, 5}};
/// Probability of the first technique at a state.
constexpr std::array<double, kStates> kFirstTechnique{0.25, 0.5, 0.75, 0.25, 0.5, 0.5};

constexpr int kMutations = 4;
constexpr std::array<double, kMutations> kWeights{1, 2, 3, 0.5};
// Over states, by mutation; each Z(x) divides 60 evenly.
constexpr double kSuitability[kStates][kMutations] = {{1, 1, 1, 0}, {2, 1, 0, 2}, {1, 0, 1, 2},
                                                      {0, 2, 2, 0}, {0, 0, 0, 0}, {1, 1, 1, 0}};
// Over cells, of the two mutations of numbers: 3 · first + ½ · second.
constexpr double kCellSuitability[kCells][2] = {{1, 0}, {1, 4}, {1, 0}, {2, 8}, {0, 2}, {1, 6}, {0, 0}, {3, 2}};

int choiceOf(double u, int choices) { return std::min(choices - 1, int(u * choices)); }
int stateOf(const Sample& x) { return int(x.path[0].shape); }
int cellOf(const Sample& x) { return choiceOf(x.u(NumberStream::Camera, 0)[0], kCells); }
void setState(Sample& x, int state) {
    x.path.resize(1);
    x.path[0].shape = uint32_t(state);
}
void setCell(Sample& x, int cell) {
    x.u.clear();
    x.u.append(NumberStream::Camera, Block{(cell + 0.5) / kCells, 0.5, 0.5, 0.5});
}

class ToyTarget : public Target {
public:
    ToyTarget(Space space, const Scene& scene) : space_(space), tracing_(scene) {}

    Space space() const override { return space_; }
    Tracing& tracing() override { return tracing_; }
    Reject evaluateNumbers(Sample& y, Random& random) override {
        Numbers numbers(y.u, random);
        numbers(NumberStream::Camera, 0);
        if (space_ == Space::Path) {
            setState(y, kMade[y.technique.s][cellOf(y)]);
            return evaluatePath(y);
        }
        return finish(y, kCellDensity[size_t(cellOf(y))]);
    }
    Reject evaluatePath(Sample& y) override { return finish(y, kDensity[size_t(stateOf(y))]); }
    double redrawTechnique(Sample& x, Random& random, bool invertNumbers) override {
        x.technique.s = random() < kFirstTechnique[size_t(stateOf(x))] ? 0 : 1;
        const double c = logTechnique(x);
        if (invertNumbers) {
            std::vector<int> cells;
            for (int i = 0; i < kCells; ++i)
                if (kMade[x.technique.s][i] == stateOf(x)) cells.push_back(i);
            setCell(x, cells[size_t(choiceOf(random(), int(cells.size())))]);
        }
        return c;
    }
    double logTechnique(Sample& y) override {
        const int state = stateOf(y), s = y.technique.s;
        const auto cells = std::count(kMade[s], kMade[s] + kCells, state);
        y.logDensity = std::log(double(cells) / kCells / kMeasure[size_t(state)]);
        return std::log(s == 0 ? kFirstTechnique[size_t(state)] : 1 - kFirstTechnique[size_t(state)]);
    }
    double bootstrapWeight(Random&) override { return 1; }
    bool seed(Random&, double, Sample&) override { return false; }

private:
    static Reject finish(Sample& y, double density) {
        y.logTarget = std::log(density);
        y.splats.clear();
        return density > 0 ? Reject::None : Reject::ZeroTarget;
    }

    Space space_;
    Tracing tracing_;
};

class ToyMutation : public Mutation {
public:
    ToyMutation(int number, Space target) : number_(number), target_(target) {}
    double suitability(const Sample& x) const override {
        return target_ == Space::Path ? kSuitability[stateOf(x)][number_] : kCellSuitability[cellOf(x)][number_ - 2];
    }

private:
    int number_;
    Space target_;
};

/// To another state, with probabilities that differ there and back.
class Jump : public ToyMutation {
public:
    Jump(int number, Space target, bool misstated) : ToyMutation(number, target), misstated_(misstated) {}
    Space space() const override { return Space::Path; }
    Proposal propose(const Sample& x, StepContext& context) const override {
        constexpr int way[kChoices] = {1, 1, 1, 2, 2, 5, 4, 4};
        const int from = stateOf(x), d = way[choiceOf(context.random(), kChoices)], to = (from + d) % kStates;
        const auto log = [&](int distance, int end) {
            return std::log(double(std::count(way, way + kChoices, distance)) / kChoices / kMeasure[size_t(end)]);
        };
        Proposal p;
        setState(p.y, to);
        p.logForward = log(d, to);
        p.logReverse = log(kStates - d, from);
        if (misstated_) std::swap(p.logForward, p.logReverse);
        return p;
    }

private:
    bool misstated_;
};

/// Changes states for one another; the measure changes too.
class Swap : public ToyMutation {
public:
    using ToyMutation::ToyMutation;
    Space space() const override { return Space::Path; }
    Proposal propose(const Sample& x, StepContext&) const override {
        constexpr int other[kStates] = {2, 3, 0, 1, 5, 4};
        Proposal p;
        setState(p.y, other[stateOf(x)]);
        p.logJacobian = std::log(kMeasure[size_t(stateOf(p.y))] / kMeasure[size_t(stateOf(x))]);
        return p;
    }
};

/// To a neighbouring cell, more often to the right.
class Step : public ToyMutation {
public:
    Step(int number, Space target, bool misstated) : ToyMutation(number, target), misstated_(misstated) {}
    Space space() const override { return Space::Primary; }
    Proposal propose(const Sample& x, StepContext& context) const override {
        const bool right = choiceOf(context.random(), kChoices) < 5;
        Proposal p;
        setCell(p.y, (cellOf(x) + (right ? 1 : kCells - 1)) % kCells);
        p.logForward = std::log(right ? 5.0 / 8 : 3.0 / 8);
        p.logReverse = std::log(right ? 3.0 / 8 : 5.0 / 8);
        if (misstated_) std::swap(p.logForward, p.logReverse);
        return p;
    }

private:
    bool misstated_;
};

/// To any cell.
class Fresh : public ToyMutation {
public:
    using ToyMutation::ToyMutation;
    Space space() const override { return Space::Primary; }
    bool isLargeStep() const override { return true; }
    Proposal propose(const Sample&, StepContext&) const override { return {}; }
};

class Recorder : public StepObserver {
public:
    void observe(const Chain&, const Proposal& proposal, const StepInfo& info) override {
        acceptance = info.acceptance;
        null = info.mutation < 0;
        y = acceptance > 0 ? &proposal.y : nullptr;
        to = y ? (onPaths ? stateOf(*y) : cellOf(*y)) : -1;
    }
    bool onPaths = true, null = false;
    double acceptance = 0;
    const Sample* y = nullptr;
    int to = -1;
};

}  // namespace

Enumeration enumerateKernel(Space space, bool misstated) {
    const bool onPaths = space == Space::Path;
    std::vector<MutationMix::Entry> entries;
    if (onPaths) {
        entries.push_back({"jump", kWeights[0], std::make_unique<Jump>(0, space, misstated)});
        entries.push_back({"swap", kWeights[1], std::make_unique<Swap>(1, space)});
    }
    entries.push_back({"step", kWeights[2], std::make_unique<Step>(2, space, misstated && !onPaths)});
    entries.push_back({"fresh", kWeights[3], std::make_unique<Fresh>(3, space)});
    const MutationMix mix(std::move(entries));
    Kernel kernel(mix);
    const AuditScene& scene = *auditScenes().front();
    ToyTarget target(space, scene.scene);
    Recorder recorder;
    recorder.onPaths = onPaths;

    const int states = onPaths ? kStates : kCells;
    std::vector<double> pi, after(size_t(states), 0.0);
    double total = 0;
    for (int i = 0; i < states; ++i)
        pi.push_back(onPaths ? kDensity[size_t(i)] * kMeasure[size_t(i)] : kCellDensity[size_t(i)]);
    for (const double p : pi) total += p;
    for (double& p : pi) p /= total;

    Enumeration result;
    const auto grid = [](int i, int n) { return (i + 0.5) / n; };
    const long double share = 1.0L / (double(kSelections) * kChoices * kInversions * kChoices * kChoices);
    Chain chain;
    for (int i = 0; i < states; ++i) {
        if (!(pi[size_t(i)] > 0)) continue;
        Sample start;
        onPaths ? setState(start, i) : setCell(start, i);
        start.logTarget = std::log(onPaths ? kDensity[size_t(i)] : kCellDensity[size_t(i)]);
        start.splats.clear();
        long double stays = 1;
        std::vector<long double> row(size_t(states), 0.0L);
        // A step asks for: which mutation; then a state's choice or the technique; which numbers; the numbers' choice;
        // and, in a block of its own, fresh numbers.
        for (int a = 0; a < kSelections; ++a)
            for (int b = 0; b < kChoices; ++b)
                for (int c = 0; c < kInversions; ++c)
                    for (int d = 0; d < kChoices; ++d)
                        for (int e = 0; e < kChoices; ++e) {
                            const std::array<Block, 2> script{
                                Block{grid(a, kSelections), grid(b, kChoices), grid(c, kInversions), grid(d, kChoices)},
                                Block{grid(e, kChoices), 0.5, 0.5, 0.5}};
                            Random random({}, 0, 0, script);
                            StepContext context{random, target.tracing(), scene.limits};
                            chain.x = start;
                            kernel.enter(chain);
                            kernel.step(chain, target, context, recorder);
                            ++result.steps;
                            result.nullSteps += recorder.null;
                            if (recorder.to < 0) continue;
                            row[size_t(recorder.to)] += share * recorder.acceptance;
                            stays -= share * recorder.acceptance;
                        }
        row[size_t(i)] += stays;
        for (int j = 0; j < states; ++j) after[size_t(j)] += double(pi[size_t(i)] * row[size_t(j)]);
    }
    for (int j = 0; j < states; ++j)
        result.residual = std::max(result.residual, std::abs(after[size_t(j)] - pi[size_t(j)]));
    return result;
}

}  // namespace ulam::audit
