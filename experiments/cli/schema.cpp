// ulam schema: JSON Schema for editors.

#include <fmt/format.h>

#include "core/scene/plugins.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/experiment.h"

namespace ulam {

void addSchemaCommand(CLI::App& app) {
    auto kind = std::make_shared<std::string>();
    CLI::App& command = *app.add_subcommand("schema", "JSON Schema (draft 7) for editors");
    command.add_option("kind", *kind, "")->required()->check(CLI::IsMember({"experiment", "scene"}));
    command.callback([kind] { fmt::print("{}\n", dump(*kind == "scene" ? sceneSchema() : experimentSchema())); });
}

}  // namespace ulam
