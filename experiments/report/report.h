#pragma once
// The report of a run: one HTML file that holds everything it shows and asks nobody for anything.

#include <filesystem>
#include <string>

#include "core/config/json.h"

namespace ulam {

/// Writes RUN_DIR/report.html from the other files of RUN_DIR (contract: "What a run leaves"). Needed is summary.json;
/// experiment.json, resolved.json, provenance.json, the cells' r000/result.json and all images are shown where they
/// exist. Of each cell the page holds the mean over replicates, the median and the worst replicate, the reference, and
/// maps of how much the replicates scatter and where their mean is not the reference's; the median replicate's images
/// of techniques and its chains. Where the page would be larger than kReportBytes, pictures become JPEG, maps have
/// larger blocks, all are shrunk until they fit, and of many cells fewer chains are shown. Fails with InputMissing
/// without summary.json, InvalidConfig where a file is damaged or the images of a cell differ in size, CannotWrite
/// where report.html cannot be written.
void writeReport(const std::filesystem::path& runDir);
/// The same where the summary has just been made.
void writeReport(const std::filesystem::path& runDir, const Json& summary);

/// The same page as text, of another summary than that of the folder. Errors as above.
std::string reportPage(const std::filesystem::path& runDir, const Json& summary);

/// What a page may take, in bytes, unless its tables alone take nearly as much.
inline constexpr double kReportBytes = 25e6;

}  // namespace ulam
