#include "core/config/json.h"

#include <limits>

#include "tests/support/error_of.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

JsonDocument document(const std::string& text) {
    return JsonDocument::fromText(text, "a.json");
}

std::string refusal(const std::string& text) {
    const Complaint complaint = errorOf([&] { document(text); });
    CHECK(complaint.code == (complaint.message.empty() ? ExitCode::Done : ExitCode::InvalidConfig));
    return complaint.message;
}

std::string where(const JsonDocument& doc, const std::string& pointer) {
    const auto position = doc.position(pointer);
    return position ? std::to_string(position->line) + ":" + std::to_string(position->column) : "none";
}

}  // namespace

TEST_CASE("positions of values survive comments, escapes and nesting", "[json]") {
    const auto doc = document(
        "// first \"line\"\n"
        "{\n"
        "  \"a\": 1, /* { [ */ \"b\" : [true, {\"c\\\"}\": null}, -2.5e3],\n"
        "\t\"m/n\": {\"~\": \"x]}\"},// end\r\n"
        "  \"é\": {}, \"f\": []\n"
        "}\n");
    CHECK(where(doc, "") == "2:1");
    CHECK(where(doc, "/a") == "3:8");
    CHECK(where(doc, "/b") == "3:27");
    CHECK(where(doc, "/b/0") == "3:28");
    CHECK(where(doc, "/b/1") == "3:34");
    CHECK(where(doc, "/b/1/c\"}") == "3:43");
    CHECK(where(doc, "/b/2") == "3:50");
    CHECK(where(doc, "/m~1n/~0") == "4:15");
    CHECK(where(doc, "/é") == "5:8");
    CHECK(where(doc, "/f") == "5:17");
    CHECK(where(doc, "/b/3") == "none");
    CHECK(where(doc, "/a/x") == "none");
    CHECK(where(doc, "/nothing") == "none");
    CHECK(where(doc, "a") == "none");
    CHECK(doc.json()["b"][2] == -2500.0);
    CHECK(doc.root().at("b")[1].members()[0].second.where() == "a.json:3:43 (/b/1/c\"})");
    CHECK(doc.root().where() == "a.json:2:1");
    CHECK(doc.root().at("m/n").at("~").where() == "a.json:4:15 (/m~1n/~0)");
    CHECK(doc.root().at("m/n").key() == "m/n");
}

TEST_CASE("a byte order mark takes no column", "[json]") {
    const auto doc = document("\xEF\xBB\xBF{\"a\": 1}");
    CHECK(where(doc, "") == "1:1");
    CHECK(where(doc, "/a") == "1:7");
}

TEST_CASE("members keep their order", "[json]") {
    const auto doc = document(R"({"z": 1, "a": 2, "m": 3})");
    std::string order;
    for (const auto& [name, node] : doc.root().members()) order += name;
    CHECK(order == "zam");
}

TEST_CASE("a key that stands twice is refused with both places", "[json]") {
    CHECK(refusal("{\"a\": 1,\n \"b\": {\"c\": 1, \"d\": 2,\n  \"c\": 3}}") ==
          "key \"c\" stands twice in one object, at a.json:3:3 and before at 2:8");
    CHECK(refusal(R"({"a": 1, "\u0061": 2})") ==
          "key \"a\" stands twice in one object, at a.json:1:10 and before at 1:2");
    CHECK(refusal(R"([{"a": 1}, {"a": 2}, {"b": {"a": 1}, "a": 3}])").empty());
}

TEST_CASE("broken texts are refused with their place", "[json]") {
    CHECK(refusal("{\"a\": 1,\n  \"b\": nul}").find("a.json:2:11: ") == 0);
    CHECK(refusal("{\"a\": 1} x").find("a.json:1:10: ") == 0);
    CHECK(refusal("[1, 2").find("a.json:1:6: ") == 0);
    for (const char* text :
         {"",          " ",   "{",       "}", "[1,]", "{\"a\"}", "{\"a\":}", "{a: 1}", "'a'",      "\"abc",
          "\"\\u12\"", "tru", "/* open", "/", "01",   "1.",      "-",        "[1 2]",  "\"a\nb\"", "\"\\ud800\""}) {
        INFO(text);
        CHECK_FALSE(refusal(text).empty());
    }
}

TEST_CASE("numbers that are not finite are refused", "[json]") {
    for (const char* text : {"NaN", "[Infinity]", "-Infinity", "nan", "{\"a\": 1e999}", "-1e400"}) {
        INFO(text);
        CHECK_FALSE(refusal(text).empty());
    }
    CHECK(refusal("[1, 1e999]").find("a.json:1:") == 0);
    CHECK(refusal("1" + std::string(400, '0')).find("overflow") != std::string::npos);
    CHECK(refusal("1" + std::string(100000, '0') + "e-100000").empty());
    CHECK(document("1e-999").root().number() == 0);
}

TEST_CASE("text that is not UTF-8 is refused with a message that is", "[json]") {
    for (const char* text : {"\"\xff\"", "\"\xc0\xaf\"", "{\"\xe9t\": 1}", "\"\xed\xa0\x80\""}) {
        const std::string message = refusal(text);
        CHECK_FALSE(message.empty());
        CHECK_NOTHROW(dump(Json(message)));
    }
    CHECK(refusal(std::string("{\"a\": 1}\0garbage", 16)) == "a.json:1:9: expected UTF-8 text, found a zero byte");
}

TEST_CASE("deep nesting is refused before it can hurt", "[json]") {
    const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    CHECK(refusal(nested(kMaxJsonDepth)).empty());
    CHECK(refusal(nested(kMaxJsonDepth + 1)) == "a.json:1:129: objects and arrays are nested deeper than 128 levels");
    CHECK_FALSE(refusal(std::string(10'000'000, '[')).empty());
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
    CHECK_FALSE(refusal(objects).empty());
}

TEST_CASE("every truncation and every corrupted byte is either read or refused", "[json]") {
    const std::string text =
        "\xEF\xBB\xBF// c\n{\"a\": [1, -2.5e-3, true, null, \"s\\u00e9\\n\"], /* b */ \"b\": {\"c\": {}}, \"d\": []}";
    int read = 0;
    const auto tryText = [&](const std::string& changed) {
        try {
            const auto doc = document(changed);
            for (const char* pointer : {"", "/a/4", "/b/c", "/d", "/x"}) doc.position(pointer);
            ++read;
        } catch (const Error& error) {
            CHECK(error.code() == ExitCode::InvalidConfig);
        }
    };
    for (std::size_t length = 0; length < text.size(); ++length) tryText(text.substr(0, length));
    CHECK(read == 0);
    for (std::size_t i = 0; i < text.size(); ++i)
        for (int byte = 0; byte < 256; ++byte) {
            std::string changed = text;
            changed[i] = static_cast<char>(byte);
            tryText(changed);
        }
    CHECK(read > 0);
}

TEST_CASE("a missing file is an input that is missing", "[json]") {
    const auto complaint = errorOf([] { JsonDocument::fromFile("/nowhere/scene.json"); });
    CHECK(complaint.code == ExitCode::InputMissing);
    CHECK(complaint.has("/nowhere/scene.json"));
    CHECK(errorOf([] { JsonDocument::fromFile("/"); }).code == ExitCode::InputMissing);
    CHECK(errorOf([] { JsonDocument::fromFile("/dev/zero"); }).code == ExitCode::InvalidConfig);
}

TEST_CASE("getters say what was expected, what was found and where", "[json]") {
    const auto doc =
        document("{\"s\": \"abc\", \"n\": -1.5,\n \"o\": {\"x\": [1, \"two\"]}, \"big\": 18446744073709551615}");
    const JsonNode root = doc.root();
    const auto message = [](auto call) { return errorOf(call).message; };
    CHECK(message([&] { root.at("s").number(); }) == "expected a number, found the string \"abc\" at a.json:1:7 (/s)");
    CHECK(message([&] { root.at("n").integer(); }) == "expected an integer, found -1.5 at a.json:1:19 (/n)");
    CHECK(message([&] { root.at("n").unsignedInteger(); }) ==
          "expected an integer >= 0, found -1.5 at a.json:1:19 (/n)");
    CHECK(message([&] { root.at("n").boolean(); }) == "expected true or false, found -1.5 at a.json:1:19 (/n)");
    CHECK(message([&] { root.at("o").string(); }) == "expected a string, found an object at a.json:2:7 (/o)");
    CHECK(message([&] { root.at("big").integer(); }) ==
          "expected an integer below 2^63, found 18446744073709551615 at a.json:2:33 (/big)");
    CHECK(message([&] { root.at("o").at("x").numbers(); }) ==
          "expected a number, found the string \"two\" at a.json:2:17 (/o/x/1)");
    CHECK(message([&] { root.at("o").at("x").numbers(16); }) ==
          "expected an array of 16 numbers, found an array of 2 at a.json:2:13 (/o/x)");
    CHECK(message([&] { root.at("o").at("x")[2]; }) ==
          "expected an array of 3 or more, found an array of 2 at a.json:2:13 (/o/x)");
    CHECK(message([&] { root.at("o").elements(); }) == "expected an array, found an object at a.json:2:7 (/o)");
    CHECK(message([&] { root.at("s").find("x"); }) ==
          "expected an object, found the string \"abc\" at a.json:1:7 (/s)");
    CHECK(message([&] { root.at("bog"); }) == "\"bog\" is missing from the object at a.json:1:1; it has \"big\"");
    CHECK(message([&] { root.at("o").at("missing"); }) == "\"missing\" is missing from the object at a.json:2:7 (/o)");
    CHECK(message([&] {
              root.at("o").allowOnly("key", {"xs", "value"});
          }) == "unknown key \"x\" at a.json:2:13 (/o/x); did you mean \"xs\"? Known: \"xs\", \"value\"");
    CHECK(errorOf([&] { root.at("s").number(); }).code == ExitCode::InvalidConfig);
    CHECK_FALSE(root.find("missing"));
}

TEST_CASE("getters read what fits", "[json]") {
    const JsonNode root = document("[3, 1e6, -7, true, \"s\", [1, 2.5], 18446744073709551615, 1e300]").root();
    CHECK(root.size() == 8);
    CHECK(root[0].number() == 3);
    CHECK(root[1].integer() == 1'000'000);
    CHECK(root[1].unsignedInteger() == 1'000'000);
    CHECK(root[2].integer() == -7);
    CHECK(root[3].boolean());
    CHECK(root[4].string() == "s");
    CHECK(root[5].numbers() == std::vector<double>{1, 2.5});
    CHECK(root[6].unsignedInteger() == std::numeric_limits<std::uint64_t>::max());
    CHECK(errorOf([&] { root[7].integer(); }).has("expected an integer"));
    CHECK(errorOf([&] { root[2].unsignedInteger(); }).has("expected an integer >= 0"));
}

TEST_CASE("a value made in memory has a pointer and no position", "[json]") {
    const JsonNode node(Json{{"a", {{"b", std::numeric_limits<double>::quiet_NaN()}}}});
    CHECK(node.where() == "the top level");
    CHECK(node.at("a").at("b").where() == "/a/b");
    CHECK(errorOf([&] { node.at("a").at("b").number(); }).message == "expected a number, found nan at /a/b");
}

TEST_CASE("values of a document made from parts have the place of the innermost part that covers them", "[json]") {
    const auto document = JsonDocument::fromParts(Json::parse(R"({"a": {"b": 1, "c": [2]}, "ab": 3})"), "scene.xml",
                                                  {{"", "scene.xml:1:1"}, {"/a", "scene.xml:2:3"}, {"/a/b", "scene.xml:4:5"}});
    CHECK(document.root().where() == "scene.xml:1:1");
    CHECK(document.root().at("a").at("b").where() == "scene.xml:4:5 (/a/b)");
    CHECK(document.root().at("a").at("c")[0].where() == "scene.xml:2:3 (/a/c/0)");
    CHECK(document.root().at("ab").where() == "scene.xml:1:1 (/ab)");
}

TEST_CASE("a node outlives its document", "[json]") {
    const JsonNode node = document(R"({"a": {"b": "text"}})").root().at("a").at("b");
    CHECK(node.string() == "text");
    CHECK(node.where() == "a.json:1:13 (/a/b)");
}

TEST_CASE("long and odd strings stay short and on one line in messages", "[json]") {
    const auto complaint = errorOf([] { JsonNode(Json(std::string(1'000'000, 'x') + "\n")).number(); });
    CHECK(complaint.message.size() < 200);
    CHECK(errorOf([] { JsonNode(Json("a\nb\x01\xff")).number(); }).has("\"a\\nb\\u0001\xEF\xBF\xBD\""));
}
