#include "experiments/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "core/base/error.h"
#include "core/base/file.h"
#include "experiments/engine/run_folder.h"
#include "experiments/report/cell_plan.h"
#include "experiments/report/page.h"
#include "experiments/report/report_pictures.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

constexpr double kTagBytes = 0.3e6;        ///< of a page, for the tags and sizes of some thousand images
constexpr double kFewestImageBytes = 4e6;  ///< whatever tables take

/// JSON that cannot end the element it stands in.
std::string scriptSafe(const Json& json) {
    std::string text;
    for (const char c : json.dump()) {
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    }
    return text;
}

std::string htmlText(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '&')
            safe += "&amp;";
        else if (c == '<')
            safe += "&lt;";
        else
            safe += c;
    }
    return safe;
}

/// The template with every @NAME@ replaced; what is put in is not searched again.
std::string fill(std::string_view page, const std::map<std::string_view, std::string_view>& values) {
    std::string out;
    for (std::size_t at = 0; at < page.size();) {
        const std::size_t begin = page.find('@', at);
        const std::size_t end = begin == page.npos ? page.npos : page.find('@', begin + 1);
        out += page.substr(at, begin - at);
        if (end == page.npos) break;
        out += values.at(page.substr(begin + 1, end - begin - 1));
        at = end + 1;
    }
    return out;
}

std::string makePage(const fs::path& runDir, const Json& summary) {
    const Json cells = summary.value("cells", Json::array());
    const std::string metric = summary.value("primary_metric", std::string("relmse"));
    Json results = Json::object();
    for (const Json& cell : cells) {
        const std::string name = cell.at("cell").get<std::string>();
        for (const auto& [replicate, folder] : replicateFolders(runDir / "cells" / name)) {
            const Json result = readJsonIfThere(folder / "result.json");
            if (result.is_null()) continue;
            results[name] = result;
            break;
        }
    }
    Json data = {{"summary", summary},
                 {"experiment", readJsonIfThere(runDir / "experiment.json")},
                 {"resolved", readJsonIfThere(runDir / "resolved.json")},
                 {"provenance", readJsonIfThere(runDir / "provenance.json")},
                 {"results", results}};
    const double others =
        double(scriptSafe(data).size() + page::kTemplate.size() + page::kStyle.size() + page::kScript.size());
    const PagePictures pictures =
        gatherPictures(runDir, cells, metric, std::max(kFewestImageBytes, kReportBytes - kTagBytes - others));
    data["pictures"] = pictures.cells;
    data["images"] = pictures.sizes;
    data["shrink"] = pictures.shrink;
    data["exact"] = pictures.exact;
    const std::string title = htmlText(summary.value("name", std::string("run")) + " · Ulam");
    const std::string json = scriptSafe(data);
    return fill(page::kTemplate, {{"TITLE", title},
                                  {"STYLE", page::kStyle},
                                  {"DATA", json},
                                  {"IMAGES", pictures.elements},
                                  {"SCRIPT", page::kScript}});
}

}  // namespace

std::string reportPage(const fs::path& runDir, const Json& summary) {
    try {
        return makePage(runDir, summary);
    } catch (const Json::exception& error) {
        fail(ExitCode::InvalidConfig, "{}: expected the summary of a run, found another structure: {}",
             (runDir / "summary.json").string(), error.what());
    }
}

void writeReport(const fs::path& runDir, const Json& summary) {
    writeFileAtomically(runDir / "report.html", reportPage(runDir, summary));
}

void writeReport(const fs::path& runDir) {
    writeReport(runDir, readOwnJson(runDir / "summary.json"));
}

}  // namespace ulam
