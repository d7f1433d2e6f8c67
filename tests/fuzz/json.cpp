#include "core/config/json.h"
#include "tests/fuzz/target.h"

using namespace ulam;

namespace {

/// Asks every value for everything; one of the wrong type says so.
void ask(const JsonNode& node) {
    for (const auto& question : {+[](const JsonNode& n) { n.number(); }, +[](const JsonNode& n) { n.integer(); },
                                 +[](const JsonNode& n) { n.unsignedInteger(); }, +[](const JsonNode& n) { n.boolean(); },
                                 +[](const JsonNode& n) { n.string(); }, +[](const JsonNode& n) { n.numbers(); },
                                 +[](const JsonNode& n) { n.allowOnly("member", {"type", "id"}); }})
        tolerateErrors("scene.json", [&] { question(node); });
    if (node.isObject())
        for (const auto& [name, member] : node.members()) ask(member);
    if (node.isArray())
        for (const JsonNode& element : node.elements()) ask(element);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string text(bytesOf(data, size));
    tolerateErrors("scene.json", [&] {
        const JsonDocument document = JsonDocument::fromText(text, "scene.json");
        require(JsonDocument::fromText(dump(document.json()), "scene.json").json() == document.json());
        ask(document.root());
    });
    tolerateErrors("", [&] {
        Json root = {{"a", {1, 2, {{"b", 3}}}}};
        applyOverrides(root, {text});
        dump(root);
    });
    return 0;
}
