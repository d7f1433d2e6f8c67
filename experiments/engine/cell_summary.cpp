// A cell: its replicates against their reference.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/config/json_number.h"
#include "core/image/image_io.h"
#include "core/image/metrics.h"
#include "experiments/engine/replicate.h"
#include "experiments/engine/summary.h"
#include "experiments/statistics/comparison.h"
#include "experiments/statistics/convergence.h"
#include "experiments/statistics/decomposition.h"
#include "experiments/statistics/error_spectrum.h"
#include "experiments/statistics/features.h"
#include "experiments/statistics/moments.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;
using statistics::Interval;

std::optional<Interval> meanInterval(const std::vector<double>& values, double confidence) {
    const auto all = std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
    const auto found = all ? statistics::meanInterval(values, confidence) : std::nullopt;
    return found ? std::optional(found->interval) : std::nullopt;
}

std::span<const float> channels(const Image& image) {
    return {reinterpret_cast<const float*>(image.pixels.data()), image.pixels.size() * 3};
}

struct Replicate {
    int number;
    Json result;
    Image image;
};

class CellAnalysis {
public:
    CellAnalysis(const Plan& plan, const Cell& cell, const Reference& reference, const fs::path& runDir)
        : plan_(plan),
          cell_(cell),
          reference_(reference),
          folder_(cellFolder(runDir, cell)),
          primary_(findMetric(plan.metrics.front())) {
        for (int r = 0; r < cell.task.replicates; ++r) {
            auto finished = finishedReplicate(cell.task, r, folder_);
            if (finished) replicates_.push_back({r, std::move(finished->result), std::move(finished->image)});
        }
    }

    CellSummary summarize() {
        const PlannedReference& reference = plan_.references[cell_.reference];
        Json& json = summary_.json;
        json = {{"cell", cell_.task.name}, {"scene", cell_.task.scene->name},     {"sampler", cell_.task.sampler},
                {"sweep", cell_.sweep},    {"parameters", cell_.task.parameters}, {"replicates", replicates_.size()}};
        if (replicates_.empty()) return summary_;
        json["replicate_numbers"] = Json::array();
        for (const Replicate& r : replicates_) json["replicate_numbers"].push_back(r.number);
        addMetrics();
        addDecomposition();
        for (const char* field : {"rays", "mutations", "samples", "setup_seconds", "seeding_seconds", "cpu_seconds"})
            json[field] = mean(field);
        json["seconds"] = mean("wall_seconds");
        json["normalization_cv"] = mean("normalization") > 0 && replicates_.size() > 1
                                       ? numberOrNull(statistics::coefficientOfVariation(values("normalization")))
                                       : Json(0);
        addSpectrum();
        addConvergence();
        addMutations();
        addFeatures();
        json["reference"] = reference.key;
        json["reference_image"] = "references/" + reference.key + "/image.exr";
        addOrigins();
        judgeReference();
        addWarnings();
        json["warnings"] = warnings_;
        return summary_;
    }

private:
    std::vector<double> values(const char* field) const {
        std::vector<double> v;
        for (const Replicate& r : replicates_) v.push_back(r.result.at(field).get<double>());
        return v;
    }
    double mean(const char* field) const { return statistics::mean(values(field)); }

    void addMetrics() {
        Json all = Json::object();
        for (const std::string& name : plan_.metrics) {
            const Metric& metric = findMetric(name);
            std::vector<double> full, trimmed;
            // A batch looks at the reference once; its maps are held together.
            constexpr std::size_t kBatch = 8;
            for (std::size_t begin = 0; begin < replicates_.size(); begin += kBatch) {
                std::vector<const Image*> images;
                for (std::size_t i = begin; i < std::min(begin + kBatch, replicates_.size()); ++i)
                    images.push_back(&replicates_[i].image);
                for (const Metric::Map& map : metric.errorMaps(images, reference_.image, &reference_.variance)) {
                    full.push_back(metric.value(map));
                    trimmed.push_back(metric.trimmedValue(map));
                }
            }
            const double worst = metric.higherIsBetter ? std::ranges::min(full) : std::ranges::max(full);
            Json perReplicate = Json::array();
            for (const double x : full) perReplicate.push_back(numberOrNull(x));
            all[name] = {{"mean", numberOrNull(statistics::mean(full))},
                         {"ci95", intervalOrNull(meanInterval(full, plan_.design.confidence()))},
                         {"trimmed_mean", numberOrNull(statistics::mean(trimmed))},
                         {"worst_replicate", numberOrNull(worst)},
                         {"values", perReplicate}};
            if (name == primary_.name) summary_.errors.errors = full;
        }
        summary_.json["metrics"] = std::move(all);

        double judged = 0;
        for (const Replicate& r : replicates_) {
            summary_.errors.replicates.push_back(r.number);
            judged += judgingError(plan_, reference_, r.image) / static_cast<double>(replicates_.size());
        }
        summary_.errors.referenceShare = shareOfReference(plan_, reference_, judged);
        summary_.errors.referenceVariance = referenceVariance(plan_, reference_);
        summary_.errors.halvesAgree = reference_.halvesAgree;

        std::vector<std::size_t> byError(replicates_.size());
        std::iota(byError.begin(), byError.end(), std::size_t{0});
        std::ranges::stable_sort(byError, {}, [&](std::size_t i) { return summary_.errors.errors[i]; });
        summary_.json["worst_replicate"] = replicates_[byError.back()].number;
        summary_.json["median_replicate"] = replicates_[byError[byError.size() / 2]].number;
    }

    void addDecomposition() {
        summary_.json["variance"] = summary_.json["bias_squared"] = nullptr;
        if (replicates_.size() < 2) return;
        std::vector<std::span<const float>> images;
        for (const Replicate& r : replicates_) images.push_back(channels(r.image));
        const auto parts = statistics::decompose(images, channels(reference_.image), channels(reference_.variance));
        summary_.json["variance"] = parts.variance;
        summary_.json["bias_squared"] = parts.biasSquared;
    }

    /// Of the relative errors whose mean square is relMSE without debiasing.
    void addSpectrum() {
        constexpr int kChannels = 3;
        const double epsilon = findMetric("relmse").constants.front().value;
        std::vector<std::vector<double>> values;
        for (const Replicate& r : replicates_) {
            for (int channel = 0; channel < kChannels; ++channel) {
                std::vector<double>& errors = values.emplace_back();
                for (std::size_t i = 0; i < r.image.pixels.size(); ++i) {
                    const double x = r.image.pixels[i][channel], truth = reference_.image.pixels[i][channel];
                    errors.push_back((x - truth) / std::sqrt(truth * truth + epsilon));
                }
            }
        }
        std::vector<statistics::ErrorImage> images;
        for (const auto& errors : values) images.push_back({errors, reference_.image.width, reference_.image.height});
        const auto spectrum = statistics::errorSpectrum(images, kChannels);
        summary_.json["error_spectrum"] = {{"cycles_per_pixel", spectrum.frequencies}, {"counts", spectrum.counts},
                                           {"density", spectrum.mean},          {"low", spectrum.low},
                                           {"high", spectrum.high},             {"brightness", spectrum.brightness}};
    }

    /// Snapshots that fall into the seeding of the chains show nothing yet.
    bool allHaveWork(std::size_t snapshot) const {
        return std::ranges::all_of(replicates_, [&](const Replicate& r) {
            const char* work = hasChains() ? "mutations" : "samples";
            return r.result.at("snapshots").at(snapshot).at(work).get<double>() > 0;
        });
    }
    bool hasChains() const { return mean("chains") > 0; }

    void addConvergence() {
        Json points = Json::array();
        std::vector<statistics::Curve> curves(replicates_.size());
        const Json& shots = replicates_.front().result.at("snapshots");
        for (std::size_t i = 0; i < shots.size(); ++i) {
            if (!allHaveWork(i)) continue;
            std::map<std::string, double> costs;
            std::vector<double> errors;
            for (std::size_t r = 0; r < replicates_.size(); ++r) {
                const Json& shot = replicates_[r].result.at("snapshots").at(i);
                for (const char* cost : {"seconds", "rays", "mutations", "samples"})
                    costs[cost] += shot.at(cost).get<double>() / double(replicates_.size());
                const Image image =
                    readImage(replicateFolder(folder_, replicates_[r].number) / shot.at("image").get<std::string>());
                errors.push_back(primary_.evaluate(image, reference_.image, &reference_.variance));
                curves[r].push_back({shot.at("seconds"), errors.back()});
            }
            points.push_back(point(shots[i].at("fraction"), costs, errors));
        }
        std::map<std::string, double> costs = {{"seconds", mean("wall_seconds")},
                                               {"rays", mean("rays")},
                                               {"mutations", mean("mutations")},
                                               {"samples", mean("samples")}};
        points.push_back(point(1, costs, summary_.errors.errors));
        for (std::size_t r = 0; r < replicates_.size(); ++r)
            curves[r].push_back({replicates_[r].result.at("wall_seconds"), summary_.errors.errors[r]});
        summary_.json["convergence"] = std::move(points);

        // -1 is the slope of a squared error.
        const auto slope = statistics::fitSlope(curves);
        flatter_ = slope && slope->flatter && primary_.debiased;
        summary_.json["slope"] =
            slope ? Json{{"value", slope->slope}, {"ci95", intervalOrNull(slope->ci95)}, {"flatter_than_minus_one", flatter_}}
                  : Json();
        summary_.curves = std::move(curves);
    }

    Json point(double fraction, std::map<std::string, double>& costs, const std::vector<double>& errors) const {
        return {{"fraction", fraction},
                {"seconds", costs["seconds"]},
                {"rays", costs["rays"]},
                {"mutations", costs["mutations"]},
                {"samples", costs["samples"]},
                {"error", numberOrNull(statistics::mean(errors))},
                {"ci95", intervalOrNull(meanInterval(errors, plan_.design.confidence()))}};
    }

    void addMutations() {
        Json all = Json::object();
        for (const Replicate& r : replicates_) {
            for (const auto& [name, own] : r.result.at("mutation_statistics").items()) {
                Json& sum = all[name];
                if (sum.is_null())
                    sum = {{"proposed", 0},  {"accepted", 0},     {"zero", 0}, {"rejected", Json::object()},
                           {"seconds", 0.0}, {"esjd_pixels", 0.0}};
                const double before = sum["proposed"].get<double>(), more = own.at("proposed").get<double>();
                if (before + more > 0)
                    sum["esjd_pixels"] =
                        (sum["esjd_pixels"].get<double>() * before + own.at("esjd_pixels").get<double>() * more) /
                        (before + more);
                for (const char* count : {"proposed", "accepted", "zero"})
                    sum[count] = sum[count].get<std::uint64_t>() + own.at(count).get<std::uint64_t>();
                sum["seconds"] = sum["seconds"].get<double>() + own.at("seconds").get<double>();
                for (const auto& [reason, count] : own.at("rejected").items())
                    sum["rejected"][reason] =
                        sum["rejected"].value(reason, std::uint64_t{0}) + count.get<std::uint64_t>();
            }
        }
        summary_.json["mutation_statistics"] = std::move(all);
    }

    void addFeatures() {
        const Features& features = cell_.task.scene->features;
        Json all = Json::object();
        std::vector<std::vector<double>> shares;
        std::vector<bool> dark;  // replicates without light in any feature have no shares
        for (const Replicate& r : replicates_) {
            std::vector<double> energy;
            for (const std::string& name : features.names)
                energy.push_back(r.result.at("feature_energy").value(name, 0.0));
            const double total = std::accumulate(energy.begin(), energy.end(), 0.0);
            dark.push_back(!(total > 0));
            if (dark.back()) continue;
            for (double& e : energy) e /= total;
            shares.push_back(std::move(energy));
        }
        double mutations = 0;
        std::map<std::string, double> jumps;
        for (const Replicate& r : replicates_) {
            mutations += r.result.at("mutations").get<double>();
            for (const auto& [name, count] : r.result.at("feature_jumps").items()) jumps[name] += count.get<double>();
        }
        const auto found = statistics::featureShares(shares, reference_.featureShares);
        for (std::size_t f = 0; f < found.size(); ++f) {
            std::vector<double> column;
            for (const auto& replicate : shares) column.push_back(replicate[f]);
            Json perReplicate = Json::array();
            for (std::size_t r = 0, lit = 0; r < dark.size(); ++r)
                perReplicate.push_back(dark[r] ? Json() : Json(column[lit++]));
            const std::string& name = features.names[f];
            all[name] = {{"share", found[f].share},
                         {"share_ci95", intervalOrNull(found[f].ci95)},
                         {"truth", found[f].truth ? Json(*found[f].truth) : Json()},
                         {"judged", found[f].judged},
                         {"p_adjusted", found[f].judged ? Json(found[f].pAdjusted) : Json()},
                         {"relative_sd", numberOrNull(statistics::coefficientOfVariation(column))},
                         {"jumps_per_million", mutations > 0 ? Json(1e6 * jumps[name] / mutations) : Json()},
                         {"per_replicate", perReplicate}};
            if (found[f].truth && !found[f].judged) ++unjudgedFeatures_;
            if (found[f].judged && found[f].pAdjusted < statistics::kFamilyLevel) ++wrongFeatures_;
        }
        summary_.json["features"] = std::move(all);
        summary_.json["feature_grid"] = {features.rows, features.columns};
    }

    /// What the replicates were made with.
    void addOrigins() {
        std::map<Json, int> machines, builds;
        for (const Replicate& r : replicates_) {
            ++machines[Json::object({{"processor", r.result.value("processor", "not known")},
                                     {"threads", r.result.at("threads")},
                                     {"simd", r.result.value("simd", Json())}})];
            ++builds[Json::object({{"code_sha256", r.result.value("code_sha256", "not known")}})];
        }
        for (const auto& [name, counts] : {std::pair("machines", machines), std::pair("builds", builds)}) {
            summary_.json[name] = Json::array();
            for (const auto& [key, count] : counts) {
                Json entry = key;
                entry["replicates"] = count;
                summary_.json[name].push_back(std::move(entry));
            }
        }
    }

    void judgeReference() {
        const CellErrors& found = summary_.errors;
        const bool tooNoisy =
            std::ranges::any_of(found.errors, [](double e) { return e <= 0; }) ||
            isTooPoor(found.referenceShare);
        summary_.json["reference_variance"] = found.referenceVariance;
        summary_.json["reference_share"] = numberOrNull(found.referenceShare);
        summary_.json["reference_too_poor"] = tooNoisy || !reference_.halvesAgree;
        if (tooNoisy)
            warnings_.push_back(
                "the reference is too poor: its own variance is more than 10 % of the error, which cannot be judged; "
                "raise the reference's budget, and it is extended");
        if (!reference_.halvesAgree)
            warnings_.push_back("the two halves of the reference disagree: it needs a larger budget");
    }

    void addWarnings() {
        if (replicates_.size() < std::size_t(cell_.task.replicates))
            warnings_.push_back(fmt::format("{} of {} replicates are missing",
                                            std::size_t(cell_.task.replicates) - replicates_.size(),
                                            cell_.task.replicates));
        if (flatter_)
            warnings_.push_back(fmt::format("the error falls slower than 1 / time: {}, or the image is biased",
                                            hasChains() ? "chains are trapped" : "it comes from rare bright samples"));
        if (unjudgedFeatures_ > 0)
            warnings_.push_back(fmt::format(
                "the brightness of {} of {} features scatters too much between runs to be tested with {} replicates",
                unjudgedFeatures_, cell_.task.scene->features.names.size(), replicates_.size()));
        if (wrongFeatures_ > 0)
            warnings_.push_back(
                fmt::format("the brightness of {} of {} features is wrong (t over replicates, Holm, 5 %)",
                            wrongFeatures_, cell_.task.scene->features.names.size()));
        std::uint64_t nonFinite = 0;
        int black = 0, unfinished = 0;
        for (const Replicate& r : replicates_) {
            unfinished += r.result.value("unsampled_pixels", 0) > 0;
            for (const auto& [cause, count] : r.result.at("non_finite").items())
                nonFinite += count.get<std::uint64_t>();
            black += std::ranges::all_of(r.image.pixels, [](const Rgb& p) { return p == Rgb(0); });
        }
        if (nonFinite > 0)
            warnings_.push_back(fmt::format("{} contributions were not finite and were left out", nonFinite));
        if (unfinished > 0)
            warnings_.push_back(
                fmt::format("{} of {} images have pixels without a sample, which are black: too small a budget for one "
                            "sample a pixel",
                            unfinished, replicates_.size()));
        if (black > 0)
            warnings_.push_back(
                fmt::format("{} of {} images are all black: no path carried light", black, replicates_.size()));
    }

    const Plan& plan_;
    const Cell& cell_;
    const Reference& reference_;
    fs::path folder_;
    const Metric& primary_;
    std::vector<Replicate> replicates_;
    CellSummary summary_;
    std::vector<std::string> warnings_;
    bool flatter_ = false;
    int wrongFeatures_ = 0, unjudgedFeatures_ = 0;
};

}  // namespace

CellSummary summarizeCell(const Plan& plan, const Cell& cell, const Reference& reference, const fs::path& runDir) {
    return CellAnalysis(plan, cell, reference, runDir).summarize();
}

}  // namespace ulam
