// ulam reference: the references that experiments have made, which they share.

#include <chrono>

#include "core/base/error.h"
#include "core/base/memory.h"
#include "core/config/suggest.h"
#include "core/image/image_io.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/progress.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/result.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> keys() {
    std::vector<std::string> found;
    std::error_code none;  // no cache yet
    for (const auto& entry : fs::directory_iterator(referenceCache(), none))
        if (entry.is_directory() && entry.path().filename().string().front() != '.') found.push_back(entry.path().filename().string());
    std::ranges::sort(found);
    return found;
}

double bytesOf(const fs::path& folder) {
    double bytes = 0;
    for (const auto& entry : fs::directory_iterator(folder)) bytes += double(entry.file_size());
    return bytes;
}

double secondsSince(const fs::path& file) {
    return std::chrono::duration<double>(fs::file_time_type::clock::now() - fs::last_write_time(file)).count();
}

/// What is wrong with an entry; empty: nothing.
std::string damageOf(const fs::path& folder) {
    try {
        const JsonDocument document = JsonDocument::fromFile(folder / "result.json");
        readRecordedImage(folder / "image.exr", document.root().at("image_sha256"));
        readRecordedImage(folder / "variance.exr", document.root().at("variance_sha256"));
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

Json entryJson(const std::string& key) {
    const fs::path folder = referenceCache() / key;
    Json entry = {{"key", key}, {"damage", damageOf(folder)}};
    if (!entry["damage"].get<std::string>().empty()) return entry;
    const Json result = JsonDocument::fromFile(folder / "result.json").json();
    for (const char* field :
         {"scene", "scene_hash", "parameters", "part", "replicates", "halves_agree", "wall_seconds"})
        entry[field] = result.value(field, Json());
    const Image image = readImage(folder / "image.exr");
    entry["width"] = image.width, entry["height"] = image.height;
    entry["bytes"] = bytesOf(folder);
    entry["age_seconds"] = secondsSince(folder / "result.json");
    return entry;
}

void list(bool json) {
    Json all = Json::array();
    for (const std::string& key : keys()) all.push_back(entryJson(key));
    if (json) {
        fmt::print("{}\n", dump(all));
        return;
    }
    double bytes = 0;
    int damaged = 0;
    for (const Json& entry : all) {
        const std::string damage = entry["damage"];
        if (!damage.empty()) {
            ++damaged;
            fmt::print("{}  damaged: {}\n", entry["key"].get<std::string>(), damage);
            continue;
        }
        bytes += entry["bytes"].get<double>();
        fmt::print("{}  {} {} x {}, {} parts of {}, {}{}, {} old\n", entry["key"].get<std::string>(),
                   entry["scene"].get<std::string>(), entry["width"].dump(), entry["height"].dump(),
                   entry["replicates"].dump(), entry["part"].dump(), sizeText(entry["bytes"]),
                   entry["halves_agree"] == true ? "" : ", its halves disagree", durationText(entry["age_seconds"]));
    }
    fmt::print("{} references, {}, in {}\n", all.size(), sizeText(bytes), referenceCache().string());
    if (damaged > 0) fmt::print("{} of them damaged: the next experiment that needs one makes it again\n", damaged);
}

void remove(const std::vector<std::string>& names, double days) {
    const std::vector<std::string> known = keys();
    std::vector<std::string> chosen;
    for (const std::string& name : names) {
        if (std::ranges::find(known, name) == known.end()) unknownName("reference", name, known, referenceCache().string());
        chosen.push_back(name);
    }
    if (names.empty())
        for (const std::string& key : known)
            if (secondsSince(referenceCache() / key) > days * 86400) chosen.push_back(key);
    for (const std::string& key : chosen) {
        std::error_code error;
        fs::remove_all(referenceCache() / key, error);
        if (error) fail(ExitCode::CannotWrite, "cannot remove {}: {}", (referenceCache() / key).string(), error.message());
        fmt::print("removed {}\n", key);
    }
}

}  // namespace

void addReferenceCommand(CLI::App& app) {
    CLI::App& command = *app.add_subcommand("reference", "list, check and remove the references that experiments have made");
    command.require_subcommand(1);
    auto json = std::make_shared<bool>(false);
    CLI::App& listed = *command.add_subcommand("list", "what the cache holds, checked against the hashes that were written with it");
    listed.add_flag("--json", *json, "as JSON");
    listed.callback([json] { list(*json); });

    auto names = std::make_shared<std::vector<std::string>>();
    auto days = std::make_shared<double>(-1);
    CLI::App& removed = *command.add_subcommand("remove", "remove references by key, or all that are old; runs keep their own copies");
    removed.add_option("key", *names, "as ulam reference list shows them")->type_name("KEY");
    removed.add_option("--older-than", *days, "without keys: all that were made so many days ago")->type_name("DAYS")->check(CLI::NonNegativeNumber);
    removed.callback([names, days] {
        if (names->empty() == (*days < 0)) fail(ExitCode::Usage, "give keys to remove, or --older-than DAYS");
        remove(*names, *days);
    });
}

}  // namespace ulam
