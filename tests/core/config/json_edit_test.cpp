#include <cmath>
#include <limits>

#include "core/config/json.h"
#include "tests/support/error_of.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("overrides read JSON and otherwise text", "[json][override]") {
    CHECK(overrideValue("2.5") == Json(2.5));
    CHECK(overrideValue("7").is_number_integer());
    CHECK(overrideValue("true") == Json(true));
    CHECK(overrideValue("null").is_null());
    CHECK(overrideValue("[1, 2]") == Json({1, 2}));
    CHECK(overrideValue("{\"a\": 1}") == Json{{"a", 1}});
    CHECK(overrideValue("\"7\"") == Json("7"));
    CHECK(overrideValue("balance") == Json("balance"));
    CHECK(overrideValue("scenes/a b.xml") == Json("scenes/a b.xml"));
    CHECK(overrideValue("") == Json(""));
    CHECK(overrideValue("NaN") == Json("NaN"));
    for (const char* text : {"[1, 2", "{\"a\": 1, \"a\": 2}", "\"open"})
        CHECK(errorOf([&] { overrideValue(text); }).code == ExitCode::InvalidConfig);
}

TEST_CASE("paths reach members and elements and make what is missing", "[json][override]") {
    Json root = Json::parse(R"({"samplers": {"mlt": {"chains": 10, "steps": [1, {"a": 2}]}}})");
    setByPath(root, "samplers.mlt.chains", "20");
    setByPath(root, "samplers.mlt.steps.1.a", "3");
    setByPath(root, "samplers.mlt.steps.0", "first");
    setByPath(root, "samplers.bdpt.technique_images", "true");
    setByPath(root, "budget", "{\"time\": 2}");
    CHECK(root == Json::parse(R"({"samplers": {"mlt": {"chains": 20, "steps": ["first", {"a": 3}]},
                                               "bdpt": {"technique_images": true}}, "budget": {"time": 2}})"));
}

TEST_CASE("paths that lead nowhere are refused and change nothing", "[json][override]") {
    const Json before = Json::parse(R"({"a": 1, "list": [1, 2], "text": "abc"})");
    const auto refusal = [&](const std::string& path) {
        Json root = before;
        const Complaint complaint = errorOf([&] { setByPath(root, path, "5"); });
        CHECK(complaint.code == ExitCode::InvalidConfig);
        CHECK(root == before);
        return complaint.message;
    };
    CHECK(refusal("a.b.c") == "cannot set \"a.b.c\": expected an object or array before \"b\", found 1");
    CHECK(refusal("text.x") == "cannot set \"text.x\": expected an object or array before \"x\", found \"abc\"");
    CHECK(refusal("list.2") == "cannot set \"list.2\": \"2\" is no index of an array of 2");
    for (const char* path : {"list.-1", "list.1x", "list.x", "list.99999999999999999999", "list."}) refusal(path);
    for (const char* path : {"", ".", "a.", ".a", "a..b"}) CHECK(refusal(path).find("expected a path such as") == 0);
    std::string deep = "x";
    for (int i = 0; i < 100'000; ++i) deep += ".x";
    CHECK(refusal(deep).size() < 300);
}

TEST_CASE("assignments need a path and an equals sign", "[json][override]") {
    Json root = Json::object();
    applyOverrides(root, {"a.b=1", "a.c=x=y", "d="});
    CHECK(root == Json{{"a", {{"b", 1}, {"c", "x=y"}}}, {"d", ""}});
    for (const char* nonsense : {"a.b", "=1", ""})
        CHECK(errorOf([&] { applyOverrides(root, {nonsense}); }).code == ExitCode::Usage);
}

TEST_CASE("messages about an overridden value name the override", "[json][override]") {
    auto doc = JsonDocument::fromText("{\"mlt\": {\"chains\": 10,\n \"type\": \"mlt\"}}", "a.json");
    const JsonNode old = doc.root().at("mlt").at("chains");
    doc.applyOverrides({"mlt.chains=many", "mlt.mix={\"lens\": 1}"});
    CHECK(errorOf([&] { doc.root().at("mlt").at("chains").integer(); }).message ==
          "expected an integer, found the string \"many\" at --set mlt.chains=many (/mlt/chains)");
    CHECK(doc.root().at("mlt").at("mix").at("lens").where() == "--set mlt.mix={\"lens\": 1} (/mlt/mix/lens)");
    CHECK(doc.root().at("mlt").at("type").where() == "a.json:2:10 (/mlt/type)");
    CHECK_FALSE(doc.position("/mlt/chains"));
    CHECK(old.integer() == 10);
    CHECK(old.where() == "a.json:1:20 (/mlt/chains)");

    doc.set("mlt.chains", 5, "sweep mlt.chains=5");
    CHECK(doc.root().at("mlt").at("chains").where() == "sweep mlt.chains=5 (/mlt/chains)");
    doc.set("mlt.chainsaw", 5, "sweep");
    doc.set("mlt.made", 6, "sweep");
    CHECK(doc.root().at("mlt").at("chains").where() == "sweep mlt.chains=5 (/mlt/chains)");
}

TEST_CASE("dumped JSON reads back, and nothing non-finite is ever written", "[json]") {
    const Json value = {{"a", {0.1, 1e-300, -0.0, 12345678901234567ull}}, {"b", "é\n"}, {"c", Json::object()}};
    CHECK(Json::parse(dump(value)) == value);
    CHECK(dump(Json{{"a", 1}}) == "{\n  \"a\": 1\n}");

    for (const double bad : {std::numeric_limits<double>::infinity(), -HUGE_VAL, std::nan("")}) {
        const auto complaint = errorOf([&] { dump(Json{{"metrics", {{"a/b", {1.0, bad}}}}}); });
        CHECK(complaint.code == ExitCode::CannotWrite);
        CHECK(complaint.has("/metrics/a~1b/1"));
    }
    CHECK(errorOf([] { dump(Json("\xff")); }).code == ExitCode::CannotWrite);
}
