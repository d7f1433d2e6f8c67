// A render that is interrupted and resumed, however often and wherever, ends in the bytes of one that was not.

#include <unistd.h>


#include "core/base/error.h"
#include "core/base/file.h"
#include "core/render/driver.h"
#include "tests/core/render/same_bytes.h"
#include "tests/support/known_answers.h"
#include "tests/support/level.h"
#include "tests/support/path_scenes.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

struct File {
    fs::path path = fs::temp_directory_path() / fmt::format("ulam-checkpoint-test-{}", ::getpid());
    File() { fs::remove(path); }
    ~File() { fs::remove(path); }
};

/// A sampler that hears a signal before a given piece of its work: of its preparation and of its units, all counted.
class Interrupted : public Sampler {
public:
    Interrupted(const Json& sampler, int64_t pieces)
        : sampler_(Registry<Sampler>::instance().create(JsonNode(sampler))), left_(pieces) {}

    std::atomic<bool> signal = false;
    int64_t pieces() const { return left_; }
    bool isChainSampler() const override { return sampler_->isChainSampler(); }
    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        return std::make_unique<Run>(const_cast<Interrupted&>(*this), sampler_->start(context));
    }

private:
    void count() {
        if (--left_ < 0) signal = true;
    }

    struct Run : SamplerRun {
        Run(Interrupted& o, std::unique_ptr<SamplerRun> r) : outer(o), run(std::move(r)) {}
        bool prepare(const StopFunction& stop) override {
            return run->prepare([&](int worker) {
                outer.count();
                return stop(worker);
            });
        }
        void settle() override { run->settle(); }
        uint64_t chunk() const override { return run->chunk(); }
        void work(int worker, uint64_t begin, uint64_t end) override {
            outer.count();
            run->work(worker, begin, end);
        }
        Image develop(uint64_t units) override { return run->develop(units); }
        uint64_t rays() const override { return run->rays(); }
        void report(uint64_t units, RenderStatistics& s) override { run->report(units, s); }
        void save(ByteWriter& state) override { run->save(state); }
        void restore(ByteReader& state) override { run->restore(state); }
        Json replay(const NonFiniteEvent& event) override { return run->replay(event); }

        Interrupted& outer;
        std::unique_ptr<SamplerRun> run;
    };

    std::unique_ptr<Sampler> sampler_;
    std::atomic<int64_t> left_;
};

struct Job {
    Json sampler;
    Budget budget;
};

std::vector<Job> jobs() {
    std::vector<Job> all;
    Budget spp, rays;
    spp.spp = 5.5, rays.rays = 200'000;
    for (const std::string& name : samplerNames()) {
        if (name == "portal") continue;  // needs a scene with openings
        Json sampler = {{"type", name}, {"max_depth", 5}};
        if (isChainSampler(name)) {
            sampler["chains"] = 37;
            all.push_back({sampler, rays});  // whose bootstrap is planned
            sampler["bootstrap"] = 5000;
        }
        all.push_back({sampler, spp});
    }
    all.push_back({{{"type", "bdpt"}, {"max_depth", 4}, {"technique_images", true}}, spp});
    all.push_back({{{"type", "mlt"}, {"max_depth", 4}, {"chains", 37}, {"bootstrap", 5000}, {"acceptance_images", true}}, spp});
    Budget oneRound;
    oneRound.rays = 1;  // spent at once; the round is finished all the same
    all.push_back({{{"type", "path"}, {"max_depth", 5}}, oneRound});
    return all;
}

constexpr int64_t kEndless = int64_t(1) << 40;

/// One session of a job, interrupted before one of its pieces of work; `pieces`: then those that were left.
RenderResult session(const Scene& scene, const Job& job, const fs::path& file, int64_t& pieces, int threads,
                     double interval = 1e9) {
    const Interrupted sampler(job.sampler, pieces);
    RenderOptions options;
    options.budget = job.budget;
    options.key = makeKey(5);
    options.threads = threads;
    options.snapshots = 2;
    options.interrupt = &sampler.signal;
    options.checkpoint = CheckpointPlan{.file = file, .identity = {{"sampler", job.sampler}}, .interval = interval, .resume = Resume::Yes};
    RenderResult result = render(scene, sampler, options);
    pieces = sampler.pieces();
    return result;
}

/// Everything that does not depend on time.
void checkSame(const RenderResult& a, const RenderResult& b) {
    CHECK(a.units == b.units);
    CHECK(sameBytes(a.image, b.image));
    REQUIRE(a.snapshots.size() == b.snapshots.size());
    for (size_t i = 0; i < a.snapshots.size(); ++i) {
        CHECK(sameBytes(a.snapshots[i].image, b.snapshots[i].image));
        CHECK(a.snapshots[i].rays == b.snapshots[i].rays);
    }
    const RenderStatistics &s = a.statistics, &t = b.statistics;
    CHECK(s.rays == t.rays);
    CHECK(s.samples == t.samples);
    CHECK(s.mutations == t.mutations);
    CHECK(s.chains == t.chains);
    CHECK(s.normalization == t.normalization);
    CHECK(s.featureEnergy == t.featureEnergy);
    CHECK(s.featureJumps == t.featureJumps);
    CHECK(s.seedingRays == t.seedingRays);
    CHECK(s.diagnostics == t.diagnostics);
    REQUIRE(s.mutationStatistics.size() == t.mutationStatistics.size());
    for (const auto& [name, m] : s.mutationStatistics) {
        const MutationStatistics& n = t.mutationStatistics.at(name);
        CHECK(m.proposed == n.proposed);
        CHECK(m.accepted == n.accepted);
        CHECK(m.rejected == n.rejected);
    }
    REQUIRE(s.traces.size() == t.traces.size());
    for (size_t i = 0; i < s.traces.size(); ++i) CHECK(s.traces[i].draws() == t.traces[i].draws());
    REQUIRE(s.extraImages.size() == t.extraImages.size());
    for (const auto& [name, image] : s.extraImages) CHECK(sameBytes(image, t.extraImages.at(name)));
}

}  // namespace

TEST_CASE("an interrupted render goes on to the same bytes, from any point") {
    const Scene scene = buildScene(pathScene("glass_and_mirror").dictionary);
    const File file;
    const int points = fullLevel() ? 50 : 6;
    for (const Job& job : jobs()) {
        INFO(job.sampler.dump());
        int64_t pieces = kEndless;
        const RenderResult whole = session(scene, job, file.path, pieces, 2);
        CHECK_FALSE(whole.interrupted);
        const double all = double(kEndless - pieces);
        for (int i = 0; i < points; ++i) {
            // Spread over the whole work, seeding included, and not in step with it.
            int64_t first = int64_t(all * (i + 0.37) / points), second = int64_t(all * 0.1), rest = kEndless;
            INFO("interrupted before piece " << first << " of " << all);
            const RenderResult one = session(scene, job, file.path, first, 1 + i % 3);
            CHECK(one.interrupted);
            CHECK(one.lost.empty());
            session(scene, job, file.path, second, 1 + (i + 1) % 2);
            const RenderResult last = session(scene, job, file.path, rest, 1 + i % 2);
            CHECK(last.sessions > one.sessions);
            CHECK(last.wallSeconds > one.wallSeconds);
            checkSame(last, whole);
            fs::remove(file.path);
        }
    }
}

TEST_CASE("checkpoints on the way change nothing, and each of them is enough to go on") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    const File file;
    for (const Job& job : jobs()) {
        INFO(job.sampler.dump());
        int64_t pieces = kEndless;
        const RenderResult whole = session(scene, job, file.path, pieces, 2);
        CHECK_FALSE(fs::exists(file.path));
        pieces = kEndless;
        const RenderResult kept = session(scene, job, file.path, pieces, 2, 1e-3);
        checkSame(kept, whole);
        CHECK(kept.checkpointSeconds > 0);
        CHECK(kept.sessions == 1);
        REQUIRE(fs::exists(file.path));
        // As after kill -9: the last checkpoint is all that there is.
        pieces = kEndless;
        const RenderResult last = session(scene, job, file.path, pieces, 3);
        CHECK(last.sessions == 2);
        checkSame(last, whole);
        fs::remove(file.path);
    }
}

TEST_CASE("a checkpoint that is not of this run, or damaged, is refused with what is wrong") {
    const File file;
    const CheckpointPlan plan{.file = file.path, .identity = {{"sampler", {{"type", "bdpt"}, {"max_depth", 5}}}, {"seed", 1}}};
    const std::string state("a state\n with lines and \0 zeros", 30);
    const auto message = [](const CheckpointPlan& p) {
        try {
            readCheckpoint(p);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(message(plan).find("cannot read") != std::string::npos);
    CHECK_FALSE(isCheckpointOf(plan));
    writeCheckpoint(plan, state);
    CHECK(readCheckpoint(plan) == state);
    CHECK(isCheckpointOf(plan));

    CheckpointPlan other = plan;
    other.identity["sampler"]["max_depth"] = 6;
    CHECK(message(other).find("/sampler/max_depth is 6, 5 in the checkpoint") != std::string::npos);
    other = plan;
    other.identity["budget"] = 3;
    CHECK(message(other).find("/budget is 3, not given in the checkpoint") != std::string::npos);

    const std::string good = readFile(file.path);
    for (size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = char(bad[i] ^ 0x10);
        writeFileAtomically(file.path, bad);
        INFO("byte " << i);
        CHECK_FALSE(message(plan).empty());
    }
    for (const size_t size : {size_t(0), size_t(5), good.size() / 2, good.size() - 1}) {
        writeFileAtomically(file.path, good.substr(0, size));
        CHECK_FALSE(message(plan).empty());
    }
    writeFileAtomically(file.path, "ulam checkpoint 99" + good.substr(17));
    CHECK(message(plan).find("another version") != std::string::npos);
}

TEST_CASE("a checkpoint that cannot be written is told, and the render goes on") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(Json{{"type", "path"}}));
    RenderOptions options;
    options.budget.spp = 64;
    std::string warned;
    options.checkpoint = CheckpointPlan{.file = "/nowhere/at/all", .identity = {}, .interval = 1e-3, .warn = [&](const std::string& text) { warned = text; }};
    const RenderResult result = render(scene, *sampler, options);
    CHECK_FALSE(result.interrupted);
    CHECK(warned.find("/nowhere/at/all") != std::string::npos);
}

TEST_CASE("values come back from their bytes, and bytes that are missing are noticed") {
    std::map<std::string, std::vector<double>> values = {{"a", {1, 2.5}}, {"", {}}}, back = {{"z", {1}}};
    std::optional<std::array<Vec3f, 2>> some = std::array<Vec3f, 2>{Vec3f(1, 2, 3), Vec3f(4, 5, 6)}, none = std::nullopt, x, y = some;
    ByteWriter writer;
    writer(values, some, none);
    ByteReader reader(writer.text);
    back.clear();
    reader(back, x, y);
    CHECK(reader.atEnd());
    CHECK(back == values);
    CHECK(x == some);
    CHECK(y == none);
    for (size_t size = 0; size < writer.text.size(); ++size) {
        ByteReader cut(std::string_view(writer.text).substr(0, size));
        CHECK_THROWS_AS(cut(back, x, y), std::length_error);
        back.clear();
    }
}
