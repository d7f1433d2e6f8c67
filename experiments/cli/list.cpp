// ulam list: what there is, with parameters, defaults and units.

#include <algorithm>

#include "core/base/error.h"
#include "core/config/suggest.h"
#include "core/image/metrics.h"
#include "core/mcmc/target.h"
#include "core/render/sampler.h"
#include "core/scene/plugins.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"
#include "experiments/cli/vocabulary.h"

namespace ulam {
namespace {

struct Item {
    std::string name, summary;
    std::string file;  ///< of things that are one file each
    std::vector<ParameterInfo> parameters;
};

struct Kind {
    const char* plural;
    std::vector<Item> (*items)();
};

template <class Interface>
std::vector<Item> registered() {
    std::vector<Item> items;
    for (const auto* entry : Registry<Interface>::instance().entries())
        items.push_back({entry->name, entry->summary, entry->file, entry->parameters});
    return items;
}

template <PluginKind kind>
std::vector<Item> plugins() {
    std::vector<Item> items;
    for (const PluginInfo& plugin : scenePlugins(kind))
        items.push_back({plugin.name, plugin.summary, "", plugin.parameters});
    return items;
}

std::vector<Item> metricItems() {
    std::vector<Item> items;
    for (const Metric& metric : metrics()) {
        Item item{std::string(metric.name), std::string(metric.definition), "", {}};
        for (const MetricConstant& c : metric.constants) {
            ParameterInfo constant;
            constant.name = c.name;
            constant.type = "number";
            constant.defaultValue = c.value;
            constant.help = "constant";
            item.parameters.push_back(constant);
        }
        items.push_back(item);
    }
    return items;
}

std::vector<Item> kernelItems() {
    return {{"metropolis_hastings", "accepts a proposal with probability min(1, r)", "kernel.cpp", {}}};
}

constexpr Kind kKinds[] = {
    {"samplers", registered<Sampler>},
    {"mutations", registered<Mutation>},
    {"kernels", kernelItems},
    {"targets", registered<Importance>},
    {"generators", registered<Generator>},
    {"bsdfs", plugins<PluginKind::Bsdfs>},
    {"shapes", plugins<PluginKind::Shapes>},
    {"emitters", plugins<PluginKind::Emitters>},
    {"sensors", plugins<PluginKind::Sensors>},
    {"textures", plugins<PluginKind::Textures>},
    {"metrics", metricItems},
};

Json parameterJson(const ParameterInfo& p) {
    Json json = {{"name", p.name}, {"type", p.type}, {"default", p.defaultValue}, {"help", p.help}};
    if (!p.unit.empty()) json["unit"] = p.unit;
    if (p.min) json[p.minExclusive ? "exclusive_minimum" : "minimum"] = *p.min;
    if (p.max) json[p.maxExclusive ? "exclusive_maximum" : "maximum"] = *p.max;
    if (!p.choices.empty()) json["choices"] = p.choices;
    return json;
}

Json itemJson(const Item& item) {
    Json json = {{"name", item.name}, {"summary", item.summary}};
    if (!item.file.empty()) json["file"] = item.file;
    json["parameters"] = Json::array();
    for (const ParameterInfo& p : item.parameters) json["parameters"].push_back(parameterJson(p));
    return json;
}

void printItem(const Item& item) {
    fmt::print("{}: {}\n", item.name, item.summary);
    for (const ParameterInfo& p : item.parameters) {
        const std::string range = p.range();
        fmt::print("  {:<20} {}{}\n  {:<20}   {}{}, default {}\n", p.name, p.help,
                   p.unit.empty() ? "" : " [" + p.unit + "]", "", p.type, range.empty() ? "" : ", " + range,
                   p.defaultValue.dump());
    }
}

/// All of a scene's plugins on one page.
constexpr const char* kVocabulary = "vocabulary";

void list(const std::string& plural, const std::string& name, bool json) {
    if (plural == kVocabulary) {
        if (json || !name.empty()) fail(ExitCode::Usage, "ulam list vocabulary is a page in Markdown: it takes no name and no --json");
        fmt::print("{}", sceneVocabulary());
        return;
    }
    const Kind& kind =
        *std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Kind& k) { return k.plural == plural; });
    std::vector<Item> items = kind.items();
    if (!name.empty()) {
        std::vector<std::string> names;
        for (const Item& item : items) names.push_back(item.name);
        std::erase_if(items, [&](const Item& item) { return item.name != name; });
        if (items.empty()) unknownName(plural.substr(0, plural.size() - 1), name, names, "the command line");
    }
    if (json) {
        Json all = Json::array();
        for (const Item& item : items) all.push_back(itemJson(item));
        fmt::print("{}\n", dump(all));
    } else if (!name.empty()) {
        printItem(items.front());
    } else {
        std::size_t width = 0;
        for (const Item& item : items) width = std::max(width, item.name.size());
        for (const Item& item : items) fmt::print("{:<{}}  {}\n", item.name, width, item.summary);
    }
}

}  // namespace

void addListCommand(CLI::App& app) {
    struct Arguments {
        std::string kind, name;
        bool json = false;
    };
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *app.add_subcommand("list", "what there is: names, parameters, defaults, units");
    std::vector<std::string> kinds;
    for (const Kind& kind : kKinds) kinds.emplace_back(kind.plural);
    kinds.emplace_back(kVocabulary);
    command.add_option("kind", a->kind, "")->required()->check(CLI::IsMember(kinds));
    command.add_option("name", a->name, "one of them, with its parameters");
    command.add_flag("--json", a->json, "as JSON");
    addPluginOption(command);
    command.callback([a] { list(a->kind, a->name, a->json); });
}

}  // namespace ulam
