#include "experiments/engine/extends.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/config/suggest.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// JSON pointers, and where their values were written.
using Places = std::vector<std::pair<std::string, std::string>>;

bool isOfOtherType(const Json& base, const Json& own) {
    return own.contains("type") && base.contains("type") && own["type"] != base["type"];
}

/// Puts `node` over `base`, which comes to be part of a document with `places`.
void putOver(const JsonNode& node, const JsonDocument& document, Json& base, Places& places) {
    const bool merge = base.is_object() && node.isObject() && !isOfOtherType(base, node.json());
    if (!merge) {
        base = node.json();
        const auto position = document.position(node.pointer());
        if (position) places.emplace_back(node.pointer(), fmt::format("{}:{}:{}", document.name(), position->line, position->column));
    }
    if (!node.isObject()) return;
    for (const auto& [name, member] : node.members()) putOver(member, document, base[name], places);
}

void checkFileName(const JsonNode& node, const fs::path& file) {
    if (file.empty() || file.has_parent_path()) node.expected("a file in the folder of this one", "paths in it mean the same then");
}

/// Adds a file and what it extends to `merged`. `open`: the files that extend this one.
void addFile(const fs::path& file, std::vector<fs::path> open, Json& merged, Places& places) {
    const JsonDocument document = JsonDocument::fromFile(file);
    const JsonNode root = document.root();
    if (!root.isObject()) root.expected("an experiment: an object");
    open.push_back(fs::weakly_canonical(file));
    if (const auto extends = root.find("extends")) {
        for (const JsonNode& node : extends->isArray() ? extends->elements() : std::vector{*extends}) {
            checkFileName(node, node.string());
            const fs::path other = file.parent_path() / node.string();
            if (std::find(open.begin(), open.end(), fs::weakly_canonical(other)) != open.end())
                node.fail(fmt::format("{} would extend itself", inQuotes(node.string())));
            addFile(other, open, merged, places);
        }
    }
    putOver(root, document, merged, places);
    merged.erase("extends");
}

}  // namespace

JsonDocument readExperiment(const fs::path& file) {
    JsonDocument document = JsonDocument::fromFile(file);
    if (!document.json().is_object() || !document.json().contains("extends")) return document;
    Json merged = Json::object();
    Places places{{"", document.name()}};
    addFile(file, {}, merged, places);
    return JsonDocument::fromParts(std::move(merged), document.name(), std::move(places));
}

}  // namespace ulam
