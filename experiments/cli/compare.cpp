// ulam compare: an image against a reference, by every metric.

#include <fmt/format.h>

#include <cmath>

#include "core/config/json_number.h"
#include "core/image/image_io.h"
#include "core/image/metrics.h"
#include "experiments/cli/commands.h"

namespace ulam {
namespace {

struct CompareArguments {
    std::string image, reference, variance;
    bool json = false;
};

void compareImages(const CompareArguments& a) {
    const Image image = readImage(a.image), reference = readImage(a.reference);
    std::optional<Image> variance;
    if (!a.variance.empty()) {
        variance = readImage(a.variance);
        requireVariance(*variance, a.variance);
    }
    Json values = Json::object();
    for (const Metric& metric : metrics()) {
        const Metric::Map map = metric.errorMap(image, reference, variance ? &*variance : nullptr);
        const double value = metric.value(map), trimmed = metric.trimmedValue(map);
        Json constants = Json::object();
        for (const MetricConstant& c : metric.constants) constants[std::string(c.name)] = c.value;
        values[std::string(metric.name)] = {{"value", numberOrNull(value)},
                                            {"trimmed_value", numberOrNull(trimmed)},
                                            {"debiased", metric.debiased && variance.has_value()},
                                            {"higher_is_better", metric.higherIsBetter},
                                            {"definition", metric.definition},
                                            {"constants", constants}};
        if (!a.json)
            fmt::print("{:<8} {:<12.6g} trimmed {:<12.6g} {}\n", metric.name, value, trimmed, metric.definition);
    }
    if (a.json)
        fmt::print("{}\n",
                   dump({{"schema_version", 1}, {"image", a.image}, {"reference", a.reference}, {"metrics", values}}));
}

}  // namespace

void addCompareCommand(CLI::App& app) {
    auto a = std::make_shared<CompareArguments>();
    CLI::App& command = *app.add_subcommand("compare", "compare an image with a reference by every metric");
    command.add_option("image", a->image, "EXR, HDR, PFM, PNG, JPG or TGA")->required();
    command.add_option("reference", a->reference, "image of the same size")->required();
    command.add_option("--variance", a->variance,
                       "variance of the reference per pixel; squared errors are debiased with it");
    command.add_flag("--json", a->json, "as JSON");
    command.callback([a] { compareImages(*a); });
}

}  // namespace ulam
