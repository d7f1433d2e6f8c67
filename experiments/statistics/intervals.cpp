#include "experiments/statistics/intervals.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

#include "experiments/statistics/moments.h"
#include "experiments/statistics/sign_flip.h"
#include "experiments/statistics/welch.h"

namespace ulam::statistics {
namespace {

double upperTail(double confidence) {
    return (1 + confidence) / 2;
}

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

    void add(double l) {
        squares += l * l;
        cubes += l * l * l;
    }
    void add(std::span<const double> values, double centre, double scale) {
        for (double x : values) add((x - centre) * scale);
    }
    double acceleration() const { return cubes / (6 * std::pow(squares, 1.5)); }
};

/// `draws` are the resampled statistics in any order, `replicates` the size of the smaller group.
Interval bcaInterval(std::vector<double> draws, double estimate, const Influence& influence, std::size_t replicates,
                     double confidence) {
    if (influence.squares == 0) return {estimate, estimate};
    std::sort(draws.begin(), draws.end());
    const auto [first, last] = std::equal_range(draws.begin(), draws.end(), estimate);
    const double below = static_cast<double>((first - draws.begin()) + (last - draws.begin())) / 2;
    const auto n = static_cast<double>(draws.size());
    const boost::math::normal normal;
    const double bias = boost::math::quantile(normal, std::clamp(below / n, 0.5 / n, 1 - 0.5 / n));
    const double acceleration = influence.acceleration();
    const double z = -boost::math::quantile(normal, bootstrapTail(replicates, confidence));
    const auto end = [&](double side) {
        const double shifted = bias + side;
        return quantileOfSorted(draws, boost::math::cdf(normal, bias + shifted / (1 - acceleration * shifted)));
    };
    return {end(-z), end(z)};
}

/// Student's t on the log scale.
Interval logInterval(const MeanEstimate& log, double confidence) {
    if (log.varianceOfMean == 0) return {std::exp(log.mean), std::exp(log.mean)};
    const double half = studentQuantile(log.degrees, upperTail(confidence)) * std::sqrt(log.varianceOfMean);
    return {std::exp(log.mean - half), std::exp(log.mean + half)};
}

/// Of each pair on the log of the ratio of the means, times the number of pairs.
std::vector<double> pairInfluences(std::span<const double> a, std::span<const double> b) {
    requirePairs(a, b);
    const double meanA = mean(a);
    const double meanB = mean(b);
    std::vector<double> influences(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) influences[i] = a[i] / meanA - b[i] / meanB;
    return influences;
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

double bootstrapTail(std::size_t replicates, double confidence) {
    const auto n = static_cast<double>(replicates);
    const double t = studentQuantile(n - 1, upperTail(confidence));
    return boost::math::cdf(boost::math::normal(), -t * std::sqrt(n / (n - 1)));
}

std::optional<Interval> studentInterval(std::span<const double> values, double confidence) {
    if (values.size() < 2) return std::nullopt;
    const MeanEstimate e = estimateMean(values);
    const double half = studentQuantile(e.degrees, upperTail(confidence)) * std::sqrt(e.varianceOfMean);
    return Interval{e.mean - half, e.mean + half};
}

std::optional<MeanInterval> meanInterval(std::span<const double> errors, double confidence, std::uint64_t seed) {
    if (errors.size() < 2) return std::nullopt;
    if (!allPositive(errors)) return MeanInterval{*studentInterval(errors, confidence), IntervalMethod::LinearT};
    const MeanEstimate e = estimateMean(errors);
    if (errors.size() < kBootstrapReplicates) {
        const MeanEstimate log{std::log(e.mean), e.varianceOfMean / (e.mean * e.mean), e.degrees};
        return MeanInterval{logInterval(log, confidence), IntervalMethod::LogT};
    }
    PhiloxStream random(seed);
    std::vector<double> draws(kBootstrapResamples);
    for (double& draw : draws) draw = resampledMean(errors, random);
    Influence influence;
    influence.add(errors, e.mean, 1);
    return MeanInterval{bcaInterval(std::move(draws), e.mean, influence, errors.size(), confidence),
                        IntervalMethod::Bca};
}

MeanEstimate logOfRatio(std::span<const double> a, std::span<const double> b) {
    const MeanEstimate ea = estimateMean(a);
    const MeanEstimate eb = estimateMean(b);
    const double va = ea.varianceOfMean / (ea.mean * ea.mean);
    const double vb = eb.varianceOfMean / (eb.mean * eb.mean);
    return {std::log(ea.mean / eb.mean), va + vb, welchDegrees(va, ea.degrees, vb, eb.degrees)};
}

MeanEstimate logOfPairedRatio(std::span<const double> a, std::span<const double> b) {
    const std::vector<double> influences = pairInfluences(a, b);
    const MeanEstimate centred = estimateMean(influences);
    return {std::log(mean(a) / mean(b)), centred.varianceOfMean, centred.degrees};
}

std::optional<Interval> ratioInterval(std::span<const double> a, std::span<const double> b, double confidence) {
    if (std::min(a.size(), b.size()) < 2 || !allPositive(a) || !allPositive(b)) return std::nullopt;
    if (std::min(a.size(), b.size()) < kBootstrapReplicates) return logInterval(logOfRatio(a, b), confidence);
    const double meanA = mean(a);
    const double meanB = mean(b);
    // BCa respects transformations, so that the ratio itself can be resampled; its influences are those of its log.
    PhiloxStream random(kResamplingSeed);
    std::vector<double> draws(kBootstrapResamples);
    for (double& draw : draws) {
        const double numerator = resampledMean(a, random);
        draw = numerator / resampledMean(b, random);
    }
    Influence influence;
    influence.add(a, meanA, 1 / (meanA * static_cast<double>(a.size())));
    influence.add(b, meanB, -1 / (meanB * static_cast<double>(b.size())));
    return bcaInterval(std::move(draws), meanA / meanB, influence, std::min(a.size(), b.size()), confidence);
}

std::optional<Interval> pairedRatioInterval(std::span<const double> a, std::span<const double> b, double confidence) {
    const std::size_t n = a.size();
    requirePairs(a, b);
    if (n < 2 || !allPositive(a) || !allPositive(b)) return std::nullopt;
    if (n < kBootstrapReplicates) return logInterval(logOfPairedRatio(a, b), confidence);
    PhiloxStream random(kResamplingSeed);
    std::vector<double> draws(kBootstrapResamples);
    for (double& draw : draws) {
        double sumA = 0;
        double sumB = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t i = random.index(n);
            sumA += a[i];
            sumB += b[i];
        }
        draw = sumA / sumB;
    }
    Influence influence;
    for (const double l : pairInfluences(a, b)) influence.add(l);
    return bcaInterval(std::move(draws), mean(a) / mean(b), influence, n, confidence);
}

}  // namespace ulam::statistics
