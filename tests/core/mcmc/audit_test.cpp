// The audit accepts right mutations and rejects planted bugs. Fixed seeds; statistical rejections at a level of 1e-6.

#include "core/base/archive.h"
#include "core/mcmc/audit/balance.h"
#include "core/mcmc/audit/density.h"
#include "core/mcmc/audit/enumeration.h"
#include "core/mcmc/audit/invariance.h"
#include "core/mcmc/audit/jacobian.h"
#include "core/mcmc/audit/rank.h"
#include "core/mcmc/audit/sequential.h"
#include "core/mcmc/audit/structure.h"
#include "tests/support/catch.h"
#include "tests/support/planted.h"

using namespace ulam;
using namespace ulam::audit;

namespace {

const RandomKey kKey = makeKey(20240611);

const AuditScene& sceneNamed(const std::string& name) {
    for (const auto& scene : auditScenes())
        if (scene->name == name) return *scene;
    throw std::runtime_error(name);
}

struct Audited {
    States states;
    StructureTally structure;
    BalanceTally balance;
    JacobianVerdict jacobian;
};

Audited audited(const std::string& mutation, const std::string& sceneName, Space target = Space::Path) {
    planted::registerAll();
    const AuditScene& scene = sceneNamed(sceneName);
    const Subject subject(mutation, target, partnersOf(mutation, target));
    Audited a;
    a.states = drawStates(scene, subject, kKey, 2000, 200);
    if (a.states.x.empty()) return a;
    a.structure = auditStructure(scene, subject, a.states, kKey, 0, 2000);
    a.balance = auditBalance(scene, subject, a.states, kKey, 0, 2000);
    a.jacobian = judge(auditJacobian(scene, subject, a.states, kKey, 0, 1000));
    return a;
}

double smallestInvarianceP(const std::string& mutation, const std::string& sceneName, uint64_t starts) {
    planted::registerAll();
    const AuditScene& scene = sceneNamed(sceneName);
    const Subject subject(mutation, Space::Path);
    const TestFunctions functions(scene, subject, kKey);
    const auto tests = identityTests(functions, auditInvariance(scene, subject, functions, kKey, 0, starts));
    double smallest = 1;
    for (const IdentityTest& test : tests) smallest = std::min(smallest, test.p);
    return smallest * double(tests.size());
}

double rankP(const std::string& mutation) {
    planted::registerAll();
    return rankTest(auditRanks(sceneNamed("diffuse"), Subject(mutation, Space::Primary), kKey, 0, 20'000));
}

}  // namespace

TEST_CASE("A scripted stream plays its script and goes on with its own numbers") {
    const std::vector<Block> script{{0.1, 0.2, 0.3, 0.4}};
    Random plain(kKey, 1, 2), scripted(kKey, 1, 2, script);
    plain.nextBlock();
    CHECK(scripted() == 0.1);
    CHECK(scripted.blocks() == 1);
    CHECK(scripted.nextBlock() == plain.nextBlock());
    CHECK(scripted() == 0.2);
}

TEST_CASE("Used bytes tell states apart") {
    const AuditScene& scene = sceneNamed("diffuse");
    const Subject subject("identity", Space::Path);
    Sample x = drawStates(scene, subject, kKey, 50, 1).x.at(0), y = x;
    CHECK(bytesOf(x) == bytesOf(y));
    y.path[y.path.length()].position.x += 1e-6f;
    CHECK(bytesOf(x) != bytesOf(y));
    y = x;
    y.factors.at[1].pdfToLight *= 1 + 1e-15;
    CHECK(bytesOf(x) != bytesOf(y));
}

TEST_CASE("Every registered mutation passes L0 and L1") {
    for (const auto* entry : Registry<Mutation>::instance().entries()) {
        const std::string& mutation = entry->name;
        if (mutation.starts_with("planted")) continue;
        CAPTURE(mutation);
        const Audited a = audited(mutation, "specular");
        CHECK(a.states.suitable > 0);
        CHECK(a.structure.proposals > 0);
        CHECK(a.structure.failures.count() == 0);
        CHECK(a.balance.hasDensity);
        CHECK(a.balance.pairs > 100);
        CHECK(a.balance.failures.count() == 0);
        CHECK(a.jacobian.comparisons > 50);
        CHECK(a.jacobian.failures.count() == 0);
    }
    for (const char* mutation : {"large_step", "kelemen_step", "gaussian_step"}) {
        CAPTURE(mutation);
        const Audited a = audited(mutation, "outdoor", Space::Primary);
        CHECK(a.structure.failures.count() == 0);
        CHECK(a.balance.worst < kPrimaryResidual);
        CHECK(a.balance.pairs > 100);
    }
}

TEST_CASE("A right mutation of the tests' own passes") {
    const Audited a = audited("planted_none", "diffuse");
    CHECK(a.structure.failures.count() == 0);
    CHECK(a.balance.failures.count() == 0);
    CHECK(a.jacobian.equalities > 50);
    CHECK(a.jacobian.failures.count() == 0);
    CHECK(smallestInvarianceP("planted_none", "diffuse", 10'000) > 1e-3);
}

TEST_CASE("A density that lacks its measure balances with itself, but not with the map that samples it") {
    const Audited a = audited("planted_geometry", "diffuse");
    CHECK(a.structure.failures.count() == 0);
    CHECK(a.balance.failures.count() == 0);
    CHECK(a.jacobian.failures.count() > 0);
    CHECK(smallestInvarianceP("planted_geometry", "diffuse", 40'000) < 1e-6);
}

TEST_CASE("Classes too rare to be judged are judged with others of their length") {
    const auto verdict = [](double excess, const char* lastClass) {
        JacobianTally tally;
        for (uint64_t s = 0; s < kFewestStates; ++s) {
            const std::string key = s + 1 < kFewestStates ? fmt::format("SRSS{}P +++", s) : lastClass;
            tally.classes[key].push_back({excess, true, s, s});
        }
        return judge(tally);
    };
    CHECK(verdict(0.05, "SSSSSP +++").failures.count() == 1);
    CHECK(verdict(0, "SSSSSP +++").failures.count() == 0);
    CHECK(verdict(0.05, "SSSSSP +++").classes == 1);
    CHECK(verdict(0.05, "SSSP +++").unjudged == 2);  // another length
    CHECK(verdict(0.05, "SSSP +++").failures.count() == 0);
}

TEST_CASE("Swapped densities are found") {
    CHECK(audited("planted_swapped", "diffuse").jacobian.failures.count() > 0);
    CHECK(smallestInvarianceP("planted_swapped", "diffuse", 40'000) < 1e-6);
}

TEST_CASE("A path through a wall is found") {
    CHECK(audited("planted_blind", "diffuse").structure.failures.count() > 0);
}

TEST_CASE("A mutation without logDensity is not taken for audited, but its stated densities are") {
    const Audited a = audited("planted_silent", "diffuse");
    CHECK_FALSE(a.balance.hasDensity);
    CHECK(a.jacobian.failures.count() > 0);
}

TEST_CASE("Ranks of exact starts") {
    CHECK(rankP("kelemen_step") > 1e-3);
    CHECK(rankP("gaussian_step") > 1e-3);
    CHECK(rankP("large_step") > 1e-3);
    CHECK(rankP("planted_drift") < 1e-6);
}

TEST_CASE("The sequential rule goes on only while in doubt") {
    CHECK(sequentialTest(1e-6, [](int, double) { return 0.5; }).rounds == 1);
    CHECK(sequentialTest(1e-6, [](int, double) { return 1e-9; }).rejected);
    const SequentialResult doubtful = sequentialTest(1e-6, [](int round, double size) {
        CHECK(size == (round == 0 ? 1 : kGrowth));
        return round == 0 ? 1e-3 : 0.5;
    });
    CHECK(doubtful.rounds == 2);
    CHECK_FALSE(doubtful.rejected);
}

TEST_CASE("The kernel leaves π invariant on a space small enough to enumerate") {
    for (const Space target : {Space::Path, Space::Primary}) {
        const Enumeration e = enumerateKernel(target);
        CAPTURE(int(target));
        CHECK(e.residual < kEnumerationResidual);
        CHECK(e.nullSteps > 0);
        CHECK(enumerateKernel(target, true).residual > 1e-3);
    }
}

namespace {

struct DensityVerdict {
    double p = 1;
    size_t tests = 0;
    uint64_t tooMuch = 0;
};
DensityVerdict densityOf(const std::string& mutation, const std::string& sceneName, Space target, uint64_t states,
                         uint64_t proposals) {
    planted::registerAll();
    const AuditScene& scene = sceneNamed(sceneName);
    const Subject subject(mutation, target);
    const States drawn = drawStates(scene, subject, kKey, 500, 40);
    DensityVerdict verdict;
    DensityTally all;
    for (uint64_t i = 0; i < states; ++i)
        all.merge(auditDensity(scene, subject, drawn.x[i * drawn.x.size() / states], kKey, i, proposals));
    for (const DensityTest& test : all.tests)
        for (const Marginal& m : test.marginals) verdict.p = std::min(verdict.p, m.p), ++verdict.tests;
    verdict.p *= double(verdict.tests);
    verdict.tooMuch = all.failures.count();
    return verdict;
}

}  // namespace

TEST_CASE("Proposals follow the density that the mutation states") {
    for (const char* mutation : {"planted_none", "bidirectional", "lens_subpath", "lens"}) {
        CAPTURE(mutation);
        const DensityVerdict v = densityOf(mutation, "diffuse", Space::Path, 4, 6000);
        CHECK(v.tests > 10);
        CHECK(v.p > 1e-4);
        CHECK(v.tooMuch == 0);
    }
    for (const char* mutation : {"caustic", "multi_chain"}) {
        CAPTURE(mutation);
        CHECK(densityOf(mutation, "specular", Space::Path, 4, 6000).p > 1e-5);
    }
    for (const char* mutation : {"large_step", "kelemen_step", "gaussian_step"}) {
        CAPTURE(mutation);
        const DensityVerdict v = densityOf(mutation, "diffuse", Space::Path, 3, 10'000);
        CHECK(v.tests > 20);
        CHECK(v.p > 1e-4);
    }
}

TEST_CASE("Proposals that do not follow their density are found") {
    CHECK(densityOf("planted_geometry", "diffuse", Space::Path, 4, 6000).p < 1e-6);
    CHECK(densityOf("planted_swapped", "diffuse", Space::Path, 4, 6000).p < 1e-6);
    const DensityVerdict twice = densityOf("planted_overfull", "diffuse", Space::Path, 4, 6000);
    CHECK(twice.p < 1e-6);
    CHECK(twice.tooMuch > 0);
    CHECK(densityOf("planted_narrow", "diffuse", Space::Path, 3, 10'000).p < 1e-6);
}
