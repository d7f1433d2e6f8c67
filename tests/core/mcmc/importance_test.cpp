#include "core/mcmc/target.h"
#include "tests/support/error_of.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("a target is found by the name that a sampler gives", "[target]") {
    CHECK((*makeImportance("max"))(Spectrum(1, 3, 2)) == 3);
    CHECK((*makeImportance("mean"))(Spectrum(1, 3, 2)) == 2);
    CHECK(errorOf([] { makeImportance("men"); }).has("unknown target \"men\" at /target; did you mean \"mean\"?"));
}
