#include "experiments/engine/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <set>

#include "core/base/file.h"
#include "core/base/file_lock.h"
#include "core/config/suggest.h"
#include "core/image/image_io.h"
#include "core/image/metrics.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/replicate.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFiles[] = {"image.exr", "variance.exr", "result.json"};

void write(const PlannedReference& reference, const fs::path& folder, const Image& image, const Image& variance,
           const Json& result) {
    makeFolder(folder);
    const ImageAttributes attributes = {{"ulam:version", programVersion()},
                                        {"ulam:scene", reference.scene->name},
                                        {"ulam:scene_hash", reference.scene->hash},
                                        {"ulam:sampler", reference.spec.parameters.dump()},
                                        {"ulam:seed", std::to_string(reference.task.seed)}};
    writeExr(folder / "image.exr", image, attributes);
    writeExr(folder / "variance.exr", variance, attributes);
    Json fields = {{"schema_version", 1},
                   {"key", reference.key},
                   {"scene", reference.scene->name},
                   {"scene_hash", reference.scene->hash},
                   {"image_sha256", imageHash(image)},
                   {"variance_sha256", imageHash(variance)}};
    fields.update(result);
    writeFileAtomically(folder / "result.json", dump(fields) + "\n");
}

/// The cache is a convenience: where it cannot be written, the next run makes the reference again. An entry of fewer parts
/// gives way.
void fillCache(const PlannedReference& reference, const fs::path& folder, int parts) {
    const fs::path entry = referenceCache() / reference.key;
    const fs::path temporary = referenceCache() / temporaryName(), old = referenceCache() / temporaryName();
    std::error_code error;
    try {
        makeFolder(temporary);
        for (const char* file : kFiles) writeFileAtomically(temporary / file, readFile(folder / file));
        // Of processes that extend one reference the one with most parts has the last word.
        const FileLock lock = FileLock::await(referenceCache());
        if (cachedParts(reference) < parts) {
            fs::rename(entry, old, error);
            fs::rename(temporary, entry, error);
        }
    } catch (const Error&) {
    }
    fs::remove_all(temporary, error);
    fs::remove_all(old, error);
}

Json sharesJson(const Features& features, const std::vector<statistics::MeanEstimate>& shares) {
    Json json = Json::object();
    for (std::size_t i = 0; i < shares.size(); ++i) {
        json[features.names[i]] = {{"mean", shares[i].mean}, {"variance_of_mean", shares[i].varianceOfMean}};
        if (std::isfinite(shares[i].degrees)) json[features.names[i]]["degrees"] = shares[i].degrees;
    }
    return json;
}

statistics::MeanEstimate shareFromJson(const JsonNode& json) {
    statistics::MeanEstimate share{json.at("mean").number(), json.at("variance_of_mean").number()};
    if (const auto degrees = json.find("degrees")) share.degrees = degrees->number();
    return share;
}

std::vector<statistics::MeanEstimate> sharesFromJson(const Features& features, const JsonNode& json) {
    std::vector<statistics::MeanEstimate> shares;
    for (const std::string& name : features.names) {
        const auto share = json.find(name);
        if (!share) return {};
        shares.push_back(shareFromJson(*share));
    }
    return shares;
}

/// Exact shares from energies; nothing where there is no energy.
std::vector<statistics::MeanEstimate> exactShares(const std::vector<double>& energies) {
    const double total = std::accumulate(energies.begin(), energies.end(), 0.0);
    std::vector<statistics::MeanEstimate> shares;
    for (const double energy : energies)
        if (total > 0) shares.push_back({energy / total, 0});
    return shares;
}

/// NAME.features.json beside NAME.exr: what result.json of a reference calls feature_shares.
std::vector<statistics::MeanEstimate> companionShares(const fs::path& image, const Features& features) {
    const fs::path file = fs::path(image).replace_extension(".features.json");
    if (features.empty() || !fs::exists(file)) return {};
    const JsonDocument document = JsonDocument::fromFile(file);
    document.root().allowOnly("feature", features.names);
    std::vector<statistics::MeanEstimate> shares;
    for (const std::string& name : features.names) shares.push_back(shareFromJson(document.root().at(name)));
    return shares;
}

void checkSize(const PlannedReference& reference, const Image& image, const fs::path& file) {
    const FilmSize& film = reference.scene->filmSize;
    if (image.width != film.cropWidth || image.height != film.cropHeight)
        fail(ExitCode::InvalidConfig, "{}: expected {} x {} pixels as of scene {}, found {} x {}", file.string(),
             film.cropWidth, film.cropHeight, reference.scene->name, image.width, image.height);
}

/// A stored reference. Fails, with UnreadableFile where it may yet be in order, where anything of it is missing, damaged, of another size or not what was written.
Reference load(const PlannedReference& reference, const fs::path& folder) {
    const JsonDocument document = JsonDocument::fromFile(folder / "result.json");
    const JsonNode result = document.root();
    if (result.at("key").string() != reference.key) result.at("key").expected(reference.key);
    const fs::path image = folder / "image.exr", variance = folder / "variance.exr";
    Reference loaded;
    loaded.image = readRecordedImage(image, result.at("image_sha256"));
    loaded.variance = readRecordedImage(variance, result.at("variance_sha256"));
    checkSize(reference, loaded.image, image);
    checkSize(reference, loaded.variance, variance);
    requireVariance(loaded.variance, variance);
    if (reference.spec.kind == ReferenceSpec::Kind::Sampler) {
        loaded.halvesAgree = result.at("halves_agree").boolean();
        loaded.parts = static_cast<int>(result.at("replicates").integer());
    }
    loaded.featureShares = sharesFromJson(reference.scene->features, result.at("feature_shares"));
    // One value has no variance.
    if (std::ranges::any_of(loaded.featureShares, [](const auto& share) { return share.degrees < 1; }))
        loaded.featureShares.clear();
    for (const JsonNode& bias : result.at("bias_ledger").elements()) loaded.biasLedger.push_back(bias.string());
    return loaded;
}

std::optional<Reference> loadIntact(const PlannedReference& reference, const fs::path& folder) {
    try {
        return load(reference, folder);
    } catch (const UnreadableFile&) {
        throw;
    } catch (const Error&) {
        return {};
    }
}

/// Parts that a sampler has to make all in all.
int wantedParts(const PlannedReference& reference) {
    return reference.spec.kind == ReferenceSpec::Kind::Sampler ? reference.task.replicates : 0;
}

/// Its parts stay: each is checked on its own.
void discard(const fs::path& folder) {
    std::error_code ignored;  // what cannot be removed cannot be written either, which says so
    for (const char* file : kFiles) fs::remove_all(folder / file, ignored);
}

/// Takes what the cache holds where that is more than `parts`; a damaged entry would stand in the way of the next one and
/// is removed.
void takeFromCache(const PlannedReference& reference, const fs::path& folder, int parts) {
    const fs::path cached = referenceCache() / reference.key;
    const FileLock lock = FileLock::await(referenceCache());  // so that all files are of one entry
    const int found = cachedParts(reference);
    std::error_code ignored;
    if (found == 0) fs::remove_all(cached, ignored);
    if (found <= parts) return;
    makeFolder(folder);
    for (const char* file : kFiles) writeFileAtomically(folder / file, readFile(cached / file));
}

void writeTruth(const PlannedReference& reference, const fs::path& folder) {
    const Image image = *reference.scene->generator->truth(reference.scene->filmSize);
    write(reference, folder, image, Image(image.width, image.height),
          {{"kind", "truth"},
           {"bias_ledger", Json::array()},
           {"feature_shares",
            sharesJson(reference.scene->features, exactShares(reference.scene->generator->featureShares()))}});
}

void writeFromFile(const PlannedReference& reference, const fs::path& folder) {
    const Image image = readImage(reference.spec.image), variance = readImage(reference.spec.variance);
    checkSize(reference, image, reference.spec.image);
    checkSize(reference, variance, reference.spec.variance);
    requireVariance(variance, reference.spec.variance);
    const Features& features = reference.scene->features;
    write(reference, folder, image, variance,
          {{"kind", "file"},
           {"source", reference.spec.image.string()},
           {"bias_ledger", Json::array()},
           {"feature_shares", sharesJson(features, companionShares(reference.spec.image, features))}});
}

/// A part's shares of its own energy; one without any light says nothing.
void addShares(std::vector<statistics::MeanEstimate>& shares, const Json& result, const Features& features) {
    std::vector<double> energies;
    for (const std::string& name : features.names) energies.push_back(result.at("feature_energy").value(name, 0.0));
    std::vector<double> own;
    for (const auto& share : exactShares(energies)) own.push_back(share.mean);
    addValues(shares, own);
}

void addBiases(std::vector<std::string>& ledger, const Json& result, const PlannedScene& scene) {
    const auto isIn = [](const std::vector<std::string>& known, const std::string& bias) {
        return std::ranges::find(known, bias) != known.end();
    };
    for (const std::string bias : result.at("bias_ledger"))
        if (!isIn(scene.substitutions, bias) && !isIn(ledger, bias)) ledger.push_back(bias);
}

}  // namespace

fs::path referenceFolder(const PlannedReference& reference, const fs::path& runDir) {
    return runDir / "references" / reference.key;
}

bool isReady(const PlannedReference& reference, const fs::path& runDir) {
    const auto found = loadIntact(reference, referenceFolder(reference, runDir));
    return found && found->parts >= wantedParts(reference);
}

int readyParts(const PlannedReference& reference, const fs::path& runDir) {
    const auto found = loadIntact(reference, referenceFolder(reference, runDir));
    return found ? found->parts : 0;
}

fs::path referenceCache() {
    const char* folder = std::getenv("XDG_CACHE_HOME");
    if (folder && *folder) return fs::path(folder) / "ulam/references";
    const char* home = std::getenv("HOME");
    return fs::path(home && *home ? home : "/tmp") / ".cache/ulam/references";
}

bool prepareReference(const PlannedReference& reference, const fs::path& runDir) {
    const fs::path folder = referenceFolder(reference, runDir);
    if (isReady(reference, runDir)) {
        std::error_code ignored;  // a run that was killed at the very end left them
        fs::remove_all(partsFolder(reference, runDir), ignored);
        return true;
    }
    const int parts = readyParts(reference, runDir);
    if (parts == 0) discard(folder);
    if (reference.spec.kind == ReferenceSpec::Kind::Truth) return writeTruth(reference, folder), true;
    if (reference.spec.kind == ReferenceSpec::Kind::File) return writeFromFile(reference, folder), true;
    takeFromCache(reference, folder, parts);
    return isReady(reference, runDir);
}

int cachedParts(const PlannedReference& reference) {
    try {
        const auto found = loadIntact(reference, referenceCache() / reference.key);
        return found ? found->parts : 0;
    } catch (const UnreadableFile&) {
        return 0;
    }
}

fs::path partsFolder(const PlannedReference& reference, const fs::path& runDir) {
    return referenceFolder(reference, runDir) / "parts";
}

void finishReference(const PlannedReference& reference, const fs::path& runDir) {
    const fs::path folder = referenceFolder(reference, runDir);
    const PlannedScene& scene = *reference.scene;
    CombinedParts combined;
    std::vector<statistics::MeanEstimate> shares;
    std::vector<std::string> biasLedger;
    std::map<std::string, double> totals = {{"wall_seconds", 0}, {"rays", 0}, {"samples", 0}, {"mutations", 0}};
    const auto addTotals = [&](const Json& result) {
        for (auto& [field, sum] : totals) sum += result.at(field).get<double>();
    };
    if (auto made = loadIntact(reference, folder)) {
        const JsonDocument document = JsonDocument::fromFile(folder / "result.json");
        combined = {made->parts, std::move(made->image), std::move(made->variance),
                    halvesFromJson(document.root().at("halves"))};
        shares = sharesFromJson(scene.features, document.root().at("feature_shares"));
        biasLedger = std::move(made->biasLedger);
        addTotals(document.json());
    }
    for (int part = combined.parts; part < reference.task.replicates; ++part) {
        std::string damage = "it is missing";
        auto finished = finishedReplicate(reference.task, part, partsFolder(reference, runDir), &damage);
        if (!finished) fail(ExitCode::InputMissing, "part {} of {} is lost: {}", part + 1, reference.key, damage);
        if (const auto pixels = finished->result.value("unsampled_pixels", 0); pixels > 0)
            fail(ExitCode::InvalidConfig,
                 "{} pixels have no sample in part {} of the reference of scene {}, which may spend {}: give the "
                 "reference larger parts in \"part\"",
                 pixels, part + 1, reference.scene->name, budgetJson(reference.task.budget).dump());
        combined.add(finished->image);
        addShares(shares, finished->result, scene.features);
        addBiases(biasLedger, finished->result, scene);
        addTotals(finished->result);
    }
    if (std::ranges::all_of(combined.image.pixels, [](const Rgb& p) { return p == Rgb(0); }))
        fail(ExitCode::InvalidConfig,
             "no path carried light: the reference of scene {} is black. Is the camera inside a wall, or max_depth too "
             "small?",
             reference.scene->name);
    const double smallestP = combined.smallestP();
    Json result = {{"kind", "sampler"},
                   {"parameters", reference.spec.parameters},
                   {"part", budgetJson(reference.task.budget)},
                   {"replicates", combined.parts},
                   {"halves_smallest_p", smallestP},
                   {"halves_agree", smallestP >= kHalvesLevel},
                   {"halves", halvesJson(combined)},
                   {"bias_ledger", biasLedger},
                   {"feature_shares", sharesJson(scene.features, shares)}};
    result.update(totals);
    write(reference, folder, combined.image, combined.variance, result);
    fillCache(reference, folder, combined.parts);
    fs::remove_all(partsFolder(reference, runDir));
}

std::vector<std::string> sharedBiasWarnings(const Plan& plan) {
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < plan.references.size(); ++i) {
        const ReferenceSpec& spec = plan.references[i].spec;
        if (spec.kind != ReferenceSpec::Kind::Sampler) continue;
        const Json& type = spec.parameters.at("type");
        std::set<std::string> judged;
        for (const Cell& cell : plan.cells)
            if (cell.reference == i && cell.task.parameters.at("type") == type) judged.insert(cell.task.sampler);
        if (judged.empty()) continue;
        std::string warning = fmt::format(
            "{}: the reference's sampler is of the same type, {}, as {}: a bias that they share would not be seen",
            plan.references[i].scene->name, type.get<std::string>(), fmt::join(judged, ", "));
        if (std::ranges::find(warnings, warning) == warnings.end())
            warnings.push_back(std::move(warning));  // once for a sweep
    }
    return warnings;
}

Reference readReference(const PlannedReference& reference, const fs::path& runDir) {
    return load(reference, referenceFolder(reference, runDir));
}

}  // namespace ulam
