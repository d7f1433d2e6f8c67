#include "core/config/parameters.h"

#include <cmath>
#include <limits>

#include "tests/support/error_of.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

struct Everything {
    double radius = 0.1;
    float exponent = 0.1f;
    int chains = 1000;
    std::int64_t offset = -5;
    std::uint32_t count = 3;
    std::uint64_t seed = 1;
    bool adapt = true;
    std::string heuristic = "balance";
    std::vector<double> weights = {0.5, 1};
    Spectrum tint = Spectrum(1, 0.5, 0.25);
    Json extra;
    JsonNode mutations = JsonNode(Json::object());

    template <class V>
    void describe(V& v) {
        v("radius", radius, {.help = "smallest jump", .unit = "pixels", .min = 0, .max = 100, .minExclusive = true});
        v("exponent", exponent, {.help = "of the falloff", .max = 1, .maxExclusive = true});
        v("chains", chains, {.help = "how many", .min = 1});
        v("offset", offset, {.help = "of the first"});
        v("count", count, {.help = "of samples"});
        v("seed", seed, {.help = "of the generator"});
        v("adapt", adapt, {.help = "change the radius while warming up"});
        v("heuristic", heuristic, {.help = "weights of techniques", .choices = {"balance", "power"}});
        v("weights", weights, {.help = "of the mutations", .min = 0});
        v("tint", tint, {.help = "colour", .min = 0, .max = 1});
        v("extra", extra, {.help = "anything"});
        v("mutations", mutations, {.help = "by name"});
    }
};

Everything parse(const std::string& text) {
    return parseParameters<Everything>(JsonDocument::fromText(text, "a.json").root());
}

std::string parameterRefusal(const std::string& text) {
    const auto complaint = errorOf([&] { parse(text); });
    CHECK(complaint.code == ExitCode::InvalidConfig);
    return complaint.message;
}

}  // namespace

TEST_CASE("what is not given keeps its default", "[parameters]") {
    const Everything p = parse(R"({"type": "everything"})");
    CHECK(toJson(p) == toJson(Everything()));
    CHECK(p.radius == 0.1);
}

TEST_CASE("every type is read", "[parameters]") {
    const Everything p = parse(R"({
        "radius": 2, "exponent": 0.25, "chains": 1e3, "offset": -9223372036854775808, "count": 4294967295,
        "seed": 18446744073709551615, "adapt": false, "heuristic": "power", "weights": [1, 2, 3],
        "tint": {"type": "rgb", "value": [0, 0.5, 1]}, "extra": [1, {"a": null}],
        "mutations": {"lens": {"weight": 2}}})");
    CHECK(p.radius == 2);
    CHECK(p.exponent == 0.25f);
    CHECK(p.chains == 1000);
    CHECK(p.offset == std::numeric_limits<std::int64_t>::min());
    CHECK(p.count == 4294967295u);
    CHECK(p.seed == std::numeric_limits<std::uint64_t>::max());
    CHECK_FALSE(p.adapt);
    CHECK(p.heuristic == "power");
    CHECK(p.weights == std::vector<double>{1, 2, 3});
    CHECK(p.tint == Spectrum(0, 0.5, 1));
    CHECK(p.extra == Json::parse(R"([1, {"a": null}])"));
    CHECK(p.mutations.at("lens").at("weight").where() == "a.json:5:42 (/mutations/lens/weight)");
}

TEST_CASE("colours are numbers, triples or rgb objects", "[parameters]") {
    CHECK(parse(R"({"tint": 0.5})").tint == Spectrum(0.5));
    CHECK(parse(R"({"tint": [0.5, 0, 1]})").tint == Spectrum(0.5, 0, 1));
    CHECK(parse(R"({"tint": {"type": "rgb", "value": 0.25}})").tint == Spectrum(0.25));
    const std::string forms = "expected a colour (a number, [r,g,b] or {\"type\": \"rgb\", \"value\": …}), found ";
    CHECK(parameterRefusal(R"({"tint": "red"})") == forms + "the string \"red\" at a.json:1:10 (/tint)");
    CHECK(parameterRefusal(R"({"tint": [1, 2]})") == forms + "an array of 2 at a.json:1:10 (/tint)");
    CHECK(parameterRefusal(R"({"tint": {"type": "blackbody"}})") == forms + "an object at a.json:1:10 (/tint)");
    CHECK(parameterRefusal(R"({"tint": {"type": "rgb"}})") == "\"value\" is missing from the object at a.json:1:10 (/tint)");
    CHECK(parameterRefusal(R"({"tint": {"type": "rgb", "value": [1, 1, "x"]}})").find("expected a number, found") == 0);
    CHECK(parameterRefusal(R"({"tint": {"type": "rgb", "value": {"type": "rgb", "value": 1}}})").find("expected a number or") ==
          0);
    CHECK(parameterRefusal(R"({"tint": {"type": "rgb", "value": 1, "scale": 2}})").find("unknown key of a colour \"scale\"") ==
          0);
    CHECK(parameterRefusal(R"({"tint": [0, 2, 0]})").find("0 <= x <= 1 for \"tint\", found an array of 3") != std::string::npos);
}

TEST_CASE("unknown keys are refused with the nearest name", "[parameters]") {
    const std::string message = parameterRefusal("{\"type\": \"x\",\n \"chanis\": 3}");
    CHECK(message.find("unknown parameter \"chanis\" at a.json:2:12 (/chanis); did you mean \"chains\"? Known: ") == 0);
    CHECK(message.find("\"heuristic\"") != std::string::npos);
    const auto node = JsonDocument::fromText(R"({"weight": 1, "radius": 2})", "a.json").root();
    CHECK(parseParameters<Everything>(node, {"type", "weight"}).radius == 2);
    CHECK(errorOf([&] { parseParameters<Everything>(node); }).has("unknown parameter \"weight\""));
    CHECK(parameterRefusal("[]") == "expected an object, found an empty array at a.json:1:1");
}

TEST_CASE("values of the wrong type are refused", "[parameters]") {
    CHECK(parameterRefusal(R"({"radius": "2"})") == "expected a number, found the string \"2\" at a.json:1:12 (/radius)");
    CHECK(parameterRefusal(R"({"radius": null})").find("expected a number, found null") == 0);
    CHECK(parameterRefusal(R"({"chains": 1.5})").find("expected an integer, found 1.5") == 0);
    CHECK(parameterRefusal(R"({"adapt": 1})").find("expected true or false, found 1") == 0);
    CHECK(parameterRefusal(R"({"heuristic": 1})").find("expected a string, found 1") == 0);
    CHECK(parameterRefusal(R"({"weights": 1})").find("expected an array of numbers, found 1") == 0);
    CHECK(parameterRefusal(R"({"weights": [1, true]})").find("expected a number, found true at a.json:1:17 (/weights/1)") == 0);
}

TEST_CASE("bounds are kept, open and closed", "[parameters]") {
    CHECK(parameterRefusal(R"({"radius": 0})") ==
          "expected a number, 0 < x <= 100 pixels for \"radius\", found 0 at a.json:1:12 (/radius)");
    CHECK(parse(R"({"radius": 100})").radius == 100);
    CHECK(parameterRefusal(R"({"radius": 100.5})").find("found 100.5") != std::string::npos);
    CHECK(parameterRefusal(R"({"exponent": 1})").find("expected a number, x < 1 for \"exponent\", found 1") == 0);
    CHECK(parameterRefusal(R"({"chains": 0})").find("expected an integer, 1 <= x for \"chains\", found 0") == 0);
    CHECK(parameterRefusal(R"({"weights": [0, -1]})").find("0 <= x for \"weights\", found -1 at a.json:1:17 (/weights/1)") !=
          std::string::npos);
    const JsonNode nan(Json{{"radius", std::nan("")}});
    CHECK(errorOf([&] { parseParameters<Everything>(nan); }).has("expected a number, found nan at /radius"));
}

TEST_CASE("what the type of a member cannot hold is refused", "[parameters]") {
    CHECK(parameterRefusal(R"({"count": -1})").find("expected an integer >= 0, found -1") == 0);
    CHECK(parameterRefusal(R"({"count": 4294967296})").find("expected an integer from 0 to 4294967295") == 0);
    CHECK(parameterRefusal(R"({"chains": 2147483648})").find("expected an integer from -2147483648 to 2147483647") == 0);
    CHECK(parameterRefusal(R"({"offset": 9223372036854775808})").find("expected an integer below 2^63") == 0);
    CHECK(parameterRefusal(R"({"seed": 18446744073709551616})").find("expected an integer") == 0);
    CHECK(parameterRefusal(R"({"exponent": -1e39})").find("expected a number within single precision") == 0);
}

TEST_CASE("choices are kept", "[parameters]") {
    CHECK(parameterRefusal(R"({"heuristic": "blance"})") ==
          "expected one of \"balance\", \"power\" for \"heuristic\", found the string \"blance\" at a.json:1:15 "
          "(/heuristic); did you mean \"balance\"?");
    CHECK(parameterRefusal(R"({"heuristic": ""})").find("did you mean") == std::string::npos);
}

TEST_CASE("resolved values read back to the same", "[parameters]") {
    const Everything p = parse(R"({"radius": 0.3, "exponent": 0.7, "tint": 0.1, "mutations": {"lens": {}}})");
    const Json resolved = toJson(p);
    CHECK(resolved.size() == 12);
    CHECK(resolved["exponent"].dump() == "0.7");
    const auto again = parseParameters<Everything>(JsonNode(Json::parse(dump(resolved))));
    CHECK(toJson(again) == resolved);
    CHECK(again.exponent == p.exponent);
}

TEST_CASE("information about parameters", "[parameters]") {
    const auto info = parameterInfo<Everything>();
    REQUIRE(info.size() == 12);
    std::string types;
    for (const auto& parameter : info) types += parameter.type + ' ';
    CHECK(types == "number number integer integer integer integer boolean string numbers spectrum json json ");
    CHECK(info[0].name == "radius");
    CHECK(info[0].unit == "pixels");
    CHECK(info[0].help == "smallest jump");
    CHECK(info[0].defaultValue == Json(0.1));
    CHECK(info[0].range() == "0 < x <= 100");
    CHECK(info[1].defaultValue.dump() == "0.1");
    CHECK(info[1].range() == "x < 1");
    CHECK(info[3].range().empty());
    CHECK(info[7].range() == "balance | power");
    CHECK(info[9].defaultValue == Json({1.0, 0.5, 0.25}));
}

TEST_CASE("the JSON Schema says the same as the description", "[parameters]") {
    const Json schema = jsonSchema(parameterInfo<Everything>());
    CHECK(schema["type"] == "object");
    CHECK(schema["additionalProperties"] == false);
    const Json& properties = schema["properties"];
    CHECK(properties.size() == 12);
    CHECK(properties["radius"] == Json::parse(R"({"type": "number", "exclusiveMinimum": 0.0, "maximum": 100.0,
                                                  "description": "smallest jump [pixels]", "default": 0.1, "examples": [0.1]})"));
    CHECK(properties["exponent"]["exclusiveMaximum"] == 1.0);
    CHECK(properties["chains"]["type"] == "integer");
    CHECK(properties["adapt"]["type"] == "boolean");
    CHECK(properties["heuristic"]["enum"] == Json({"balance", "power"}));
    CHECK(properties["weights"]["type"] == "array");
    CHECK(properties["weights"]["items"]["minimum"] == 0.0);
    CHECK(properties["tint"]["anyOf"].size() == 3);
    CHECK(properties["tint"]["anyOf"][1]["minItems"] == 3);
    CHECK_FALSE(properties["extra"].contains("type"));
    CHECK_FALSE(properties["extra"].contains("default"));
}

namespace {

struct DescribedTwice {
    int a = 0, b = 0;
    template <class V>
    void describe(V& v) {
        v("a", a, {.help = "one"});
        v("a", b, {.help = "two"});
    }
};

struct DefaultOutOfRange {
    double rate = 2;
    template <class V>
    void describe(V& v) {
        v("rate", rate, {.help = "of large steps", .min = 0, .max = 1});
    }
};

struct WithExample {
    double rate = 0.5;
    JsonNode steps;
    template <class V>
    void describe(V& v) {
        v("rate", rate, {.help = "of large steps"});
        v("steps", steps, {.help = "one after another", .example = R"([{"type": "scale", "value": 2}])"});
    }
};

struct ExampleOutOfRange {
    double rate = 0.5;
    template <class V>
    void describe(V& v) {
        v("rate", rate, {.help = "of large steps", .min = 0, .max = 1, .example = "2"});
    }
};

}  // namespace

TEST_CASE("an example is the default, or what a description says instead", "[parameters]") {
    const Json schema = jsonSchema(parameterInfo<WithExample>());
    CHECK(schema["properties"]["rate"]["examples"] == Json::parse("[0.5]"));
    CHECK(schema["properties"]["steps"]["examples"] == Json::parse(R"([[{"type": "scale", "value": 2}]])"));
}

TEST_CASE("mistakes in a description are found", "[parameters]") {
    CHECK(errorOf([] { parameterInfo<DescribedTwice>(); }).message == "parameter \"a\" is described twice");
    CHECK(errorOf([] { parameterInfo<DefaultOutOfRange>(); })
              .has("the default or example of parameter \"rate\" breaks its own description: expected a number, 0 <= x "
                   "<= 1"));
    CHECK(errorOf([] { parameterInfo<ExampleOutOfRange>(); })
              .has("the default or example of parameter \"rate\" breaks its own description: expected a number, 0 <= x "
                   "<= 1"));
}
