// ulam report: makes the report of a finished run again.

#include "experiments/report/report.h"

#include <fmt/format.h>

#include "core/base/file.h"
#include "experiments/cli/commands.h"

namespace ulam {

void addReportCommand(CLI::App& app) {
    auto folder = std::make_shared<std::string>();
    CLI::App& command = *app.add_subcommand("report", "make the report of a run again");
    command.add_option("run", *folder, "folder of the run")->type_name("RUN_DIR")->required();
    command.callback([folder] {
        writeReport(*folder);
        removeTemporaries(*folder, Below::No);
        fmt::print("{}\n", (std::filesystem::path(*folder) / "report.html").string());
    });
}

}  // namespace ulam
