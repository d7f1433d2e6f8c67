#include "experiments/engine/summary.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "experiments/engine/provenance.h"
#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;
namespace fs = std::filesystem;

namespace {

/// Changes a field of a finished replicate, and gives what it was.
Json changed(const Folder& folder, const char* field, const Json& value) {
    const fs::path file = folder / "run/cells/wall-bdpt/r001/result.json";
    Json result = JsonDocument::fromFile(file).json();
    Json before = std::exchange(result[field], value);
    writeFileAtomically(file, dump(result));
    return before;
}

Json summaryOf(const Folder& folder, const Json& experiment) {
    const Plan plan = planOf(folder, experiment);
    runIn(folder, plan);
    return summarize(plan, folder / "run", {});
}

}  // namespace

TEST_CASE("the summary has what scripts and the report read", "[summary]") {
    const Folder folder;
    const Json summary = summaryOf(folder, tinyExperiment());
    for (const char* key : {"schema_version", "name", "primary_metric", "cells", "comparisons", "verdicts", "warnings"})
        CHECK(summary.contains(key));
    REQUIRE(summary["cells"].size() == 2);
    for (const Json& cell : summary["cells"]) {
        for (const char* key : {"cell",
                                "scene",
                                "sampler",
                                "parameters",
                                "replicates",
                                "replicate_numbers",
                                "metrics",
                                "variance",
                                "bias_squared",
                                "seconds",
                                "rays",
                                "mutations",
                                "normalization_cv",
                                "convergence",
                                "slope",
                                "mutation_statistics",
                                "features",
                                "feature_grid",
                                "reference",
                                "reference_image",
                                "reference_too_poor",
                                "warnings",
                                "worst_replicate",
                                "median_replicate"})
            CHECK(cell.contains(key));
        const Json& metric = cell["metrics"]["relmse"];
        REQUIRE(metric["values"].size() == 3);
        CHECK(metric["ci95"][0] < metric["mean"]);
        CHECK(metric["mean"] < metric["ci95"][1]);
        CHECK(metric["trimmed_mean"].get<double>() <= metric["mean"].get<double>() * (1 + 1e-12));
        CHECK(metric["values"][cell["worst_replicate"].get<std::size_t>()] == metric["worst_replicate"]);
        CHECK(cell["convergence"].size() == 3);
        CHECK(cell["convergence"][0]["error"] > cell["convergence"][2]["error"]);
        CHECK(cell["convergence"][2]["error"] == metric["mean"]);
        CHECK(fs::exists(folder / "run" / cell["reference_image"].get<std::string>()));
    }
    REQUIRE(summary["comparisons"].size() == 1);
    for (const char* key : {"scene", "sampler", "baseline", "metric", "ratio", "ci95", "speedup", "speedup_ci95", "p",
                            "p_adjusted", "verdict"})
        CHECK(summary["comparisons"][0].contains(key));
    // Three replicates cannot decide anything.
    CHECK(summary["comparisons"][0]["verdict"] == "undecided");
    CHECK(mentions(summary["verdicts"][0], "wall: bdpt has "));
}

TEST_CASE("arrays over replicates say whose values they hold", "[summary]") {
    const Folder folder;
    const Json experiment = fourHoles();
    const Plan plan = planOf(folder, experiment);
    runIn(folder, plan);
    const Json whole = summarize(plan, folder / "run", {})["cells"][0];
    CHECK(whole["replicate_numbers"] == Json{0, 1, 2});
    const fs::path cell = folder / "run/cells" / whole["cell"].get<std::string>();
    fs::remove_all(cell / "r000");
    Json dark = JsonDocument::fromFile(cell / "r001/result.json").json();
    for (Json& energy : dark["feature_energy"]) energy = 0;
    writeFileAtomically(cell / "r001/result.json", dump(dark));
    const Json part = summarize(plan, folder / "run", {})["cells"][0];
    CHECK(part["replicate_numbers"] == Json{1, 2});
    for (int i = 0; i < 2; ++i) CHECK(part["metrics"]["relmse"]["values"][i] == whole["metrics"]["relmse"]["values"][i + 1]);
    for (const auto& [name, feature] : part["features"].items()) {
        REQUIRE(feature["per_replicate"].size() == 2);
        CHECK(feature["per_replicate"][0].is_null());
        CHECK(feature["per_replicate"][1] == whole["features"][name]["per_replicate"][2]);
    }
}

TEST_CASE("any number of threads makes the same summary, and tells of each cell before it", "[summary]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    std::vector<std::string> cells;
    std::vector<double> fractions;
    const auto summary = summarize(plan, folder / "run", {}, 3, [&](double fraction, const std::string& cell) {
        fractions.push_back(fraction);
        cells.push_back(cell);
    });
    CHECK(summary == summarize(plan, folder / "run", {}));
    CHECK(fractions == std::vector<double>{0, 0.5});
    std::ranges::sort(cells);
    CHECK(cells == std::vector<std::string>{"wall-bdpt", "wall-path"});
    CHECK_THROWS_WITH(
        summarize(plan, folder / "run", {}, 2, [](double, const std::string&) { throw std::runtime_error("enough"); }),
        "enough");
}

TEST_CASE("images with pixels that have no sample are told of", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["samplers"]["light"] = {{"type", "light"}};
    experiment["budget"] = {{"spp", 0.75}};
    const Json summary = summaryOf(folder, experiment);
    for (const Json& cell : summary["cells"])
        CHECK(mentions(cell["warnings"].dump(), "3 of 3 images have pixels without a sample") ==
              (cell["sampler"] != "light"));
    const Json result = JsonDocument::fromFile(folder / "run/cells/wall-path/r001/result.json").json();
    CHECK(result["unsampled_pixels"] == 64);
    CHECK(mentions(result["bias_ledger"].dump(), "64 of 256 pixels have no sample and are black"));
}

TEST_CASE("a clear difference is decided", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["replicates"] = 6;
    // Walks from the light rarely meet a given pixel: many times the error.
    experiment["samplers"] = {{"light", {{"type", "light"}}}, {"bdpt", {{"type", "bdpt"}}}};
    experiment["baseline"] = "light";
    const Json summary = summaryOf(folder, experiment);
    CHECK(summary["comparisons"][0]["p_adjusted"].get<double>() < 0.05);
    CHECK(summary["comparisons"][0]["verdict"] == "better");
    CHECK(mentions(summary["verdicts"][0], ": better"));
}

TEST_CASE("a reference worse than the images decides nothing and says so", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["budget"]["spp"] = 256;
    experiment["reference"]["budget"]["spp"] = 16;
    experiment["reference"]["part"]["spp"] = 4;
    const Json summary = summaryOf(folder, experiment);
    for (const Json& cell : summary["cells"]) CHECK(cell["reference_too_poor"] == true);
    CHECK(summary["comparisons"][0]["verdict"] == "undecided");
    CHECK(mentions(summary["verdicts"][0], "too poor"));
    CHECK(mentions(summary["warnings"].dump(), "too poor"));
}

TEST_CASE("the summary tells of biases of the reference", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    const Json plain = summaryOf(folder, experiment)["warnings"];
    CHECK(mentions(plain.dump(), "of the same type, bdpt, as bdpt"));
    CHECK_FALSE(mentions(plain.dump(), "is biased"));

    const Folder other;
    experiment["scenes"]["wall"]["mirror"] = {{"type", "sphere"}, {"radius", 0.5}, {"bsdf", {{"type", "conductor"}}}};
    experiment["reference"]["sampler"] = "light";
    const Json biased = summaryOf(other, experiment)["warnings"];
    CHECK_FALSE(mentions(biased.dump(), "of the same type"));
    CHECK(mentions(biased.dump(), "wall: the reference is biased: walks from the light cannot join mirrors"));
}

TEST_CASE("a poor reference is found out by metrics that are not debiased, too", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["budget"]["spp"] = 256;
    experiment["metrics"] = Json::array({"mape"});
    experiment["reference"]["budget"]["spp"] = 16;
    experiment["reference"]["part"]["spp"] = 4;
    const Json summary = summaryOf(folder, experiment);
    for (const Json& cell : summary["cells"]) CHECK(cell["reference_too_poor"] == true);
    CHECK(summary["comparisons"][0]["reference_too_poor"] == true);
    CHECK(summary["comparisons"][0]["verdict"] == "undecided");
}

TEST_CASE("results of different builds are told of, and not gone on with in silence", "[summary]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    const auto warnings = [&] { return summarize(plan, folder / "run", {})["warnings"].dump(); };
    CHECK_FALSE(mentions(warnings(), "different builds"));
    CHECK(changed(folder, "code_sha256", "other code") == codeHash());
    CHECK(mentions(warnings(), "results of different builds of the program or its plug-ins stand in 1 of 1 planned comparisons"));
    CHECK(mentions(warnings(), "other code"));
    CHECK(summarize(plan, folder / "run", {})["cells"][0]["builds"].size() +
              summarize(plan, folder / "run", {})["cells"][1]["builds"].size() == 3);
}

TEST_CASE("other numbers of threads make a machine unlike", "[summary]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    changed(folder, "threads", 64);
    CHECK(mentions(summarize(plan, folder / "run", {})["warnings"].dump(), "64 threads"));
}

TEST_CASE("results of unlike machines in one comparison are told of", "[summary]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    const auto warnings = [&] { return summarize(plan, folder / "run", {})["warnings"].dump(); };
    CHECK_FALSE(mentions(warnings(), "unlike machines"));
    const fs::path file = folder / "run/cells/wall-bdpt/r001/result.json";
    Json result = JsonDocument::fromFile(file).json();
    CHECK(result["host"] == hostName());
    const std::string here = result["processor"];
    result["processor"] = "another processor";
    writeFileAtomically(file, dump(result));
    CHECK(mentions(warnings(), "results of unlike machines stand in 1 of 1 planned comparisons"));
    CHECK(mentions(warnings(), "another processor"));
    const Json cell = summarize(plan, folder / "run", {})["cells"][1];
    REQUIRE(cell["machines"].size() == 2);
    for (const Json& machine : cell["machines"]) CHECK(machine["replicates"] == (machine["processor"] == here ? 2 : 1));
}

TEST_CASE("features come with their truth", "[summary]") {
    const Folder folder;
    Json experiment = fourHoles();
    experiment["budget"]["spp"] = 64;
    const Json summary = summaryOf(folder, experiment);
    const Json& cell = summary["cells"][0];
    CHECK(cell["feature_grid"] == Json{2, 2});
    REQUIRE(cell["features"].size() == 4);
    double sum = 0;
    for (const auto& [name, feature] : cell["features"].items()) {
        sum += feature["share"].get<double>();
        CHECK(feature["truth"].get<double>() == Approx(0.25).epsilon(1e-3));
        CHECK(feature["per_replicate"].size() == 3);
        CHECK(feature["jumps_per_million"].is_null());
    }
    CHECK(sum == Approx(1));
}

TEST_CASE("jumps of chains are counted where they lead to", "[summary]") {
    const Folder folder;
    Json experiment = fourHoles();
    experiment["budget"]["spp"] = 64;
    // Every proposal is independent of the state, so that three of four accepted ones lead to another of four like
    // holes.
    experiment["samplers"]["bdpt"] = {{"type", "pssmlt"}, {"mutations", {{"large_step", {{"weight", 1}}}}}};
    const Json summary = summaryOf(folder, experiment);
    const auto cell = std::ranges::find(summary["cells"], "emitter-bdpt", [](const Json& c) { return c["cell"]; });
    REQUIRE(cell != summary["cells"].end());
    const Json& largeStep = (*cell)["mutation_statistics"]["large_step"];
    const double accepted = 1e6 * largeStep["accepted"].get<double>() / largeStep["proposed"].get<double>();
    double sum = 0;
    for (const auto& [name, feature] : (*cell)["features"].items()) {
        const double jumps = feature["jumps_per_million"];
        sum += jumps;
        CHECK(jumps == Approx(accepted * 3 / 16).epsilon(0.1));
    }
    CHECK(sum == Approx(accepted * 3 / 4).epsilon(0.03));
}

TEST_CASE("chains report their mutations", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["samplers"] = {{"chains", {{"type", "pssmlt"}}}};
    experiment["baseline"] = "";
    experiment["budget"] = {{"spp", 16}};
    const Json summary = summaryOf(folder, experiment);
    const Json& cell = summary["cells"][0];
    CHECK(cell["normalization_cv"].get<double>() > 0);
    CHECK(cell["mutations"].get<double>() >= 16 * 256);
    double proposed = 0;
    for (const auto& [name, m] : cell["mutation_statistics"].items()) {
        proposed += m["proposed"].get<double>();
        CHECK(m["accepted"] <= m["proposed"]);
    }
    CHECK(proposed == Approx(3 * cell["mutations"].get<double>()));
    CHECK(summary["comparisons"].empty());
}

TEST_CASE("snapshots from before the first mutation are no part of the convergence", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["samplers"] = {{"chains", {{"type", "pssmlt"}}}};
    experiment["baseline"] = "";
    experiment["budget"] = {{"time", 0.5}};
    experiment["snapshots"] = 20;  // the first is due after half a microsecond
    const Json summary = summaryOf(folder, experiment);
    const Json& convergence = summary["cells"][0]["convergence"];
    CHECK(convergence.size() < 21);
    CHECK(convergence.back()["fraction"] == 1);
    for (const Json& point : convergence) CHECK(point["mutations"].get<double>() > 0);
}

TEST_CASE("tables have a row for each cell", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["sweep"] = {{"samplers.bdpt.rr_depth", {3, 4}}};
    const Json summary = summaryOf(folder, experiment);
    const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
    CHECK(lines(summaryCsv(summary)) == 1 + 3 * 2);
    CHECK(mentions(summaryMarkdown(summary), "| wall-bdpt,rr_depth=4 | 3 |"));
    CHECK(mentions(summaryCsv(summary), "\"wall-bdpt,rr_depth=4\""));
    CHECK(mentions(summaryLatex(summary), "\\toprule"));
    CHECK(mentions(summaryLatex(summary), "bdpt, rr\\_depth 4"));
    writeSummary(folder / "run", summary);
    for (const char* file : {"summary.json", "summary.csv", "comparisons.csv", "summary.md", "summary.tex"})
        CHECK(fs::exists(folder / "run" / file));
}

TEST_CASE("tables of numbers have the swept values and the comparisons", "[summary]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["sweep"] = {{"samplers.bdpt.rr_depth", {3, 4}}, {"film.rfilter", {{{"type", "box"}}, {{"type", "tent"}, {"radius", 1.5}}}}};
    Json summary = summaryOf(folder, experiment);
    const std::string csv = summaryCsv(summary);
    CHECK(mentions(csv, ",normalization_cv,sweep.film.rfilter,sweep.samplers.bdpt.rr_depth\n"));
    CHECK(mentions(csv, ",\"{\"\"type\"\":\"\"tent\"\",\"\"radius\"\":1.5}\",\n"));  // of path, which has no rr_depth
    CHECK(mentions(csv, ",\"{\"\"type\"\":\"\"box\"\"}\",4\n"));

    Json& comparison = summary["comparisons"][1];
    comparison.update(Json{{"ratio", 0.5}, {"ci95", {0.25, 0.75}}, {"speedup", 2}, {"speedup_ci95", {1.5, nullptr}}, {"p", 0.125}, {"p_adjusted", 0.25}, {"detectable_ratio", nullptr}});
    const std::string comparisons = comparisonsCsv(summary);
    CHECK(std::count(comparisons.begin(), comparisons.end(), '\n') == 1 + 4);
    CHECK(mentions(comparisons, "wall,bdpt,path,relmse,0.5,0.25,0.75,2,1.5,,0.125,0.25,undecided,,false,false,"));
    CHECK(mentions(comparisons, ",heavy_tailed,sweep.film.rfilter,sweep.samplers.bdpt.rr_depth\n"));
}

TEST_CASE("LaTeX gets swept values by names that tell them apart, and no commands", "[summary]") {
    const Folder folder;
    Json summary = summaryOf(folder, tinyExperiment());
    Json& cell = summary["cells"][1];
    cell["sweep"] = {{"samplers.m.mutations.lens.weight", 0.125}, {"samplers.m.mutations.large_step.weight", 0.25}, {"film.width", 8}};
    cell["scene"] = "a\\b^c~d_e%{f}";
    const std::string tex = summaryLatex(summary);
    CHECK(mentions(tex, ", lens.weight 0.125, large\\_step.weight 0.25, width 8 &"));
    CHECK(mentions(tex, "a\\textbackslash{}b\\textasciicircum{}c\\textasciitilde{}d\\_e\\%\\{f\\} &"));
}

TEST_CASE("LaTeX gets powers of ten and infinity", "[summary]") {
    const Folder folder;
    Json summary = summaryOf(folder, tinyExperiment());
    Json& comparison = summary["comparisons"][0];
    comparison["p_adjusted"] = 1.2e-5;
    comparison["ratio"] = 3.4e20;
    comparison["ci95"] = Json::array({1.0, nullptr});
    const std::string tex = summaryLatex(summary);
    CHECK(mentions(tex, "$1.2\\cdot10^{-5}$"));
    CHECK(mentions(tex, "$3.4\\cdot10^{20}$ (1--$\\infty$)"));
}
