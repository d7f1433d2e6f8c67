#include "core/config/suggest.h"

#include "tests/support/error_of.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("the nearest name has the fewest edits", "[suggest]") {
    const std::vector<std::string> names = {"bidirectional", "lens", "caustic", "multi_chain", "bdpt"};
    CHECK(nearestName("lense", names) == "lens");
    CHECK(nearestName("Lens", names) == "lens");
    CHECK(nearestName("bdtp", names) == "bdpt");
    CHECK(nearestName("multichain", names) == "multi_chain");
    CHECK(nearestName("bidirectionnal", names) == "bidirectional");
    CHECK(nearestName("causitc", names) == "caustic");
}

TEST_CASE("far names suggest nothing", "[suggest]") {
    CHECK(nearestName("photon", {"lens", "caustic"}).empty());
    CHECK(nearestName("", {"lens", "", "a"}).empty());
    CHECK(nearestName("x", {"", "yz"}).empty());
    CHECK(nearestName("x", {"y"}).empty());
    CHECK(nearestName("lens", {}).empty());
    CHECK(nearestName(std::string(1'000'000, 'a'), {"lens"}).empty());
}

TEST_CASE("of equally near names the first is suggested", "[suggest]") {
    CHECK(nearestName("cat", {"bat", "hat"}) == "bat");
}

TEST_CASE("an unknown name is named with its place, the nearest one and all others", "[suggest]") {
    const auto complaint = errorOf([] {
        unknownName("mutation", "lense", {"caustic", "lens"}, "file:3:9 (/mutations/lense)");
    });
    CHECK(complaint.code == ExitCode::InvalidConfig);
    CHECK(complaint.message ==
          "unknown mutation \"lense\" at file:3:9 (/mutations/lense); did you mean \"lens\"? Known: \"caustic\", "
          "\"lens\"");
    CHECK(errorOf([] { unknownName("mutation", "x", {}, "/x"); }).message ==
          "unknown mutation \"x\" at /x; None is known");
}

TEST_CASE("printable text is one line, short and UTF-8", "[suggest]") {
    CHECK(printable("a\tb\r") == "a\\u0009b\\u000d");
    CHECK(printable("ééé", 3) == "é…");
    CHECK(printable("éé", 4) == "éé");
    CHECK(printable("\xff") == "\xEF\xBF\xBD");
    CHECK(inQuotes("a\nb") == "\"a\\nb\"");
}
