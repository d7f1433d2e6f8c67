#include "experiments/statistics/intervals.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

#include "experiments/statistics/moments.h"
#include "experiments/statistics/welch.h"

namespace ulam::statistics {
namespace {

constexpr double kUpperTail = (1 + kConfidence) / 2;

bool allPositive(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return x > 0; });
}

double resampledMean(std::span<const double> values, PhiloxStream& random) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += values[random.index(values.size())];
    return sum / static_cast<double>(values.size());
}

/// Second and third power sums of the influence of each replicate on the statistic, over all groups.
struct Influence {
    double squares = 0;
    double cubes = 0;

    void add(std::span<const double> values, double centre, double scale) {
        for (double x : values) {
            const double l = (x - centre) * scale;
            squares += l * l;
            cubes += l * l * l;
        }
    }
    double acceleration() const { return cubes / (6 * std::pow(squares, 1.5)); }
};

/// `draws` are the resampled statistics in any order, `replicates` the size of the smaller group.
Interval bcaInterval(std::vector<double> draws, double estimate, const Influence& influence, std::size_t replicates) {
    if (influence.squares == 0) return {estimate, estimate};
    std::sort(draws.begin(), draws.end());
    const auto [first, last] = std::equal_range(draws.begin(), draws.end(), estimate);
    const double below = static_cast<double>((first - draws.begin()) + (last - draws.begin())) / 2;
    const auto n = static_cast<double>(draws.size());
    const boost::math::normal normal;
    const double bias = boost::math::quantile(normal, std::clamp(below / n, 0.5 / n, 1 - 0.5 / n));
    const double acceleration = influence.acceleration();
    const double z = -boost::math::quantile(normal, bootstrapTail(replicates));
    const auto end = [&](double side) {
        const double shifted = bias + side;
        return quantileOfSorted(draws, boost::math::cdf(normal, bias + shifted / (1 - acceleration * shifted)));
    };
    return {end(-z), end(z)};
}

/// The delta method on the log scale: relative half-width t · standard deviation of the log of the estimate.
Interval logInterval(double estimate, double varianceOfLog, double degrees) {
    if (varianceOfLog == 0) return {estimate, estimate};
    const double factor = std::exp(studentQuantile(degrees, kUpperTail) * std::sqrt(varianceOfLog));
    return {estimate / factor, estimate * factor};
}

}  // namespace

std::string_view intervalMethodName(IntervalMethod method) {
    switch (method) {
        case IntervalMethod::LogT:
            return "t on the log scale";
        case IntervalMethod::LinearT:
            return "t on the linear scale";
        case IntervalMethod::Bca:
            return "BCa bootstrap";
    }
    return "";
}

double bootstrapTail(std::size_t replicates) {
    const auto n = static_cast<double>(replicates);
    return boost::math::cdf(boost::math::normal(), -studentQuantile(n - 1, kUpperTail) * std::sqrt(n / (n - 1)));
}

std::optional<Interval> studentInterval(std::span<const double> values) {
    if (values.size() < 2) return std::nullopt;
    const MeanEstimate e = estimateMean(values);
    const double half = studentQuantile(e.degrees, kUpperTail) * std::sqrt(e.varianceOfMean);
    return Interval{e.mean - half, e.mean + half};
}

std::optional<MeanInterval> meanInterval(std::span<const double> errors, std::uint64_t seed) {
    if (errors.size() < 2) return std::nullopt;
    if (!allPositive(errors)) return MeanInterval{*studentInterval(errors), IntervalMethod::LinearT};
    const MeanEstimate e = estimateMean(errors);
    if (errors.size() < kBootstrapReplicates) {
        return MeanInterval{logInterval(e.mean, e.varianceOfMean / (e.mean * e.mean), e.degrees), IntervalMethod::LogT};
    }
    PhiloxStream random(seed);
    std::vector<double> draws(kBootstrapResamples);
    for (double& draw : draws) draw = resampledMean(errors, random);
    Influence influence;
    influence.add(errors, e.mean, 1);
    return MeanInterval{bcaInterval(std::move(draws), e.mean, influence, errors.size()), IntervalMethod::Bca};
}

std::optional<Interval> ratioInterval(std::span<const double> a, std::span<const double> b, std::uint64_t seed) {
    if (std::min(a.size(), b.size()) < 2 || !allPositive(a) || !allPositive(b)) return std::nullopt;
    const MeanEstimate ea = estimateMean(a);
    const MeanEstimate eb = estimateMean(b);
    const double ratio = ea.mean / eb.mean;
    if (std::min(a.size(), b.size()) < kBootstrapReplicates) {
        const double va = ea.varianceOfMean / (ea.mean * ea.mean);
        const double vb = eb.varianceOfMean / (eb.mean * eb.mean);
        return logInterval(ratio, va + vb, welchDegrees(va, ea.degrees, vb, eb.degrees));
    }
    // BCa respects transformations, so that the ratio itself can be resampled; its influences are those of its log.
    PhiloxStream random(seed);
    std::vector<double> draws(kBootstrapResamples);
    for (double& draw : draws) {
        const double numerator = resampledMean(a, random);
        draw = numerator / resampledMean(b, random);
    }
    Influence influence;
    influence.add(a, ea.mean, 1 / (ea.mean * static_cast<double>(a.size())));
    influence.add(b, eb.mean, -1 / (eb.mean * static_cast<double>(b.size())));
    return bcaInterval(std::move(draws), ratio, influence, std::min(a.size(), b.size()));
}

}  // namespace ulam::statistics
