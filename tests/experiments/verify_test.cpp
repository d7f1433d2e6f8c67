// The suite: outcomes, levels that catch planted bugs, and the report. Fixed seeds, levels as in the suite.

#include "core/base/error.h"
#include "experiments/verify/mutation_audit.h"
#include "experiments/verify/page.h"
#include "experiments/verify/sampler_audit.h"
#include "experiments/verify/suite.h"
#include "experiments/verify/target_audit.h"
#include "tests/support/catch.h"
#include "tests/support/planted.h"

using namespace ulam;
using namespace ulam::verify;

namespace {

/// A tenth of the quick level; the energy interval is twice as wide.
Work smallWork() {
    Work w = quickWork();
    w.seedSamples = 2000, w.states = 100;
    w.structure = w.balance = 2000, w.jacobian = 300;
    w.densityStates = 3, w.density = 5000;
    w.starts = 10'000, w.ranks = 5000;
    w.bootstrap = 4000, w.pathMutations = 12'800, w.primaryMutations = 4096, w.samplesPerPixel = 6;
    w.energyWidth = 0.01;
    w.partners = 1;  // others that are registered here have planted bugs
    w.aloneImages = {"specular"}, w.mixedImages = {"outdoor"};
    return w;
}

SubjectReport audited(const std::string& mutation) {
    planted::registerAll();
    static References references(smallWork(), 1, 2);
    return auditMutation(mutation, {smallWork(), 1, 2, 1}, references);
}

const Finding& findingOf(const SubjectReport& report, const std::string& check) {
    for (const Finding& f : report.findings)
        if (f.check == check) return f;
    throw std::runtime_error(check);
}

}  // namespace

TEST_CASE("Registered mutations pass at every level") {
    for (const char* mutation : {"lens", "kelemen_step"}) {
        const SubjectReport report = audited(mutation);
        CHECK_FALSE(report.rejected());
        for (const Finding& f : report.findings) {
            CAPTURE(mutation, f.check, f.summary, f.details);
            CHECK(f.outcome == (f.check == "mixing" ? Outcome::Reported : Outcome::Passed));
        }
        CHECK(report.findings.size() == 10);
    }
}

TEST_CASE("Planted bugs are rejected, each by the levels that can see it") {
    const SubjectReport geometry = audited("planted_geometry");
    CHECK(geometry.rejected());
    CHECK(findingOf(geometry, "balance").outcome == Outcome::Passed);
    CHECK(findingOf(geometry, "jacobian").outcome == Outcome::Rejected);
    CHECK(findingOf(geometry, "invariance").outcome == Outcome::Rejected);
    CHECK(findingOf(geometry, "density").outcome == Outcome::Rejected);
    CHECK(findingOf(geometry, "mixed invariance").outcome == Outcome::Rejected);
    CHECK(findingOf(geometry, "mixed images").outcome == Outcome::Rejected);
    const SubjectReport blind = audited("planted_blind");
    CHECK(findingOf(blind, "structure").outcome == Outcome::Rejected);
    CHECK_FALSE(findingOf(blind, "structure").details.empty());
}

TEST_CASE("An audit can end with its first rejection") {
    planted::registerAll();
    References references(smallWork(), 1, 2);
    const SubjectReport report = auditMutation("planted_geometry", {smallWork(), 1, 2, 1, true}, references);
    CHECK(report.findings.back().check == "jacobian");
    CHECK(report.findings.back().outcome == Outcome::Rejected);
}

TEST_CASE("What cannot be audited is said") {
    const SubjectReport silent = audited("planted_silent");
    CHECK(findingOf(silent, "balance").outcome == Outcome::NotAudited);
    CHECK(findingOf(silent, "density").outcome == Outcome::NotAudited);
    CHECK_FALSE(findingOf(silent, "density").p.has_value());
    CHECK_NOTHROW(dump(toJson(Report{.seed = 1, .level = "quick", .subjects = {silent}})));
    CHECK(findingOf(silent, "density").outcome == Outcome::NotAudited);
    const SubjectReport nowhere = audited("planted_nowhere");
    REQUIRE(nowhere.findings.size() == 1);
    CHECK(nowhere.findings.front().outcome == Outcome::NotCovered);
    CHECK(nowhere.rejected());
}

TEST_CASE("Samplers agree where they are unbiased, and are not judged where they say that they are not") {
    References references(smallWork(), 2, 2);
    // Mirrors and glass are in three scenes, in two of them with a spot or the sun.
    for (const auto& [sampler, notJudged] : {std::pair("path", 2u), {"light", 3u}}) {
        const SubjectReport report = auditSampler(sampler, {smallWork(), 2, 2, 2}, references);
        CAPTURE(sampler, report.findings.front().details);
        CHECK_FALSE(report.rejected());
        CHECK(report.findings.front().details.size() == notJudged);
    }
}

TEST_CASE("The kernel passes; a target that sees no blue is rejected") {
    CHECK(auditKernel("metropolis_hastings").findings.front().outcome == Outcome::Passed);
    References references(smallWork(), 2, 2);
    planted::registerAll();
    const auto functionOf = [&](const char* target) {
        Work work = smallWork();
        work.aloneImages = {};
        return auditTarget(target, {work, 2, 2, 1}, references).findings.front().outcome;
    };
    CHECK(functionOf("luminance") == Outcome::Passed);
    CHECK(functionOf("max") == Outcome::Passed);
    CHECK(functionOf("planted_blueblind") == Outcome::Rejected);
    CHECK(functionOf("planted_squared") == Outcome::Rejected);
}

TEST_CASE("A shifted image is rejected") {
    TiledEstimate a, b;
    a.tiles = {{1.0, 1e-6, 31}, {2.0, 1e-6, 31}}, a.energy = {1.0, 1e-8, 31};
    b = a;
    CHECK(judgeImages({compare("same", a, b)}, smallWork()).outcome == Outcome::Passed);
    b.tiles[1].mean = 2.02;
    CHECK(judgeImages({compare("a tile", a, b)}, smallWork()).outcome == Outcome::Rejected);
    b = a;
    b.energy.mean = 1.001;
    CHECK(judgeImages({compare("energy", a, b)}, smallWork()).outcome == Outcome::Rejected);
    b = a;
    b.energy.varianceOfMean = 1e-3;
    CHECK(judgeImages({compare("too wide", a, b)}, smallWork()).outcome == Outcome::Rejected);
}

TEST_CASE("Unknown names are refused with the nearest one") {
    try {
        verify::verify({.mutations = {"lenss"}});
        FAIL("accepted");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::Usage);
        CHECK(std::string(error.what()).find("\"lens\"") != std::string::npos);
    }
}

TEST_CASE("The report as JSON") {
    Report report{.seed = 3, .level = "quick", .subjects = {{.kind = "mutation", .name = "m"}}};
    report.subjects[0].findings.push_back({.level = "L0", .check = "structure", .outcome = Outcome::Rejected});
    const Json json = toJson(report);
    CHECK(json["rejected"] == true);
    CHECK(json["subjects"][0]["findings"][0]["outcome"] == "rejected");
    for (const char* key : {"statistic", "p", "samples"}) CHECK(json["subjects"][0]["findings"][0].contains(key));
}

TEST_CASE("The report as a page") {
    Report report{.seed = 3, .level = "quick", .subjects = {audited("lens")}};
    report.subjects[0].findings[1].details.push_back("a < b");
    const std::string page = toHtml(report);
    CHECK(page.find("<h2>mutation lens</h2>") != std::string::npos);
    CHECK(page.find("raster x") != std::string::npos);
    CHECK(page.find("sorted p-values") != std::string::npos);
    CHECK(page.find("a &lt; b") != std::string::npos);
    // Everything is inside: nothing is loaded from elsewhere.
    for (const char* outside : {"src=", "href=\"http", "url(", "@import"}) CHECK(page.find(outside) == std::string::npos);
    const auto count = [&](std::string_view what) {
        size_t n = 0;
        for (size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) ++n;
        return n;
    };
    CHECK(count("<figure>") == count("</figure>"));
    CHECK(count("<svg") >= 8);
    CHECK(page.find("\"nan") == std::string::npos);
}
