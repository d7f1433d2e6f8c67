#include "core/render/independent_run.h"

#include "core/image/splat_queue.h"
#include "core/render/replay.h"
#include "core/render/technique_films.h"

#include <numeric>

namespace ulam {
namespace {

class BidirectionalSource : public SampleSource {
public:
    BidirectionalSource(const Scene& scene, const BidirectionalOptions& options) : scene_(scene), sampler_(scene, options) {}

    void sample(const Vec2f& raster, Numbers& numbers, ContributionSink& sink) override {
        sampler_.sample(raster, numbers, [&](const Contribution& c) {
            uint32_t feature = kNone;
            if (!scene_.features.empty()) {
                sampler_.join(c.technique, path_);
                feature = featureOf(scene_.features, path_);
            }
            sink.add(c, feature);
        });
    }
    const BidirectionalOptions& options() const override { return sampler_.options(); }
    uint64_t rays() const override { return sampler_.tracing().rays(); }

private:
    const Scene& scene_;
    BidirectionalSampler sampler_;
    Path path_;
};

constexpr int kTile = 16;  // pixels a side: what a chunk of samples covers

}  // namespace

std::unique_ptr<SampleSource> makeBidirectionalSource(const Scene& scene, const BidirectionalOptions& options) {
    return std::make_unique<BidirectionalSource>(scene, options);
}

PixelOrder::PixelOrder(int width, int height, const ReconstructionFilter& filter) : width_(width), filter_(filter) {
    const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile, tiles = columns * rows;
    // Near the golden section of their number, so that consecutive tiles are far apart.
    int stride = std::max(1, int(0.6180339887 * tiles));
    while (std::gcd(stride, tiles) != 1) ++stride;
    order_.reserve(size_t(width) * size_t(height));
    for (int i = 0, tile = 0; i < tiles; ++i, tile = (tile + stride) % tiles) {
        const int x0 = tile % columns * kTile, y0 = tile / columns * kTile;
        for (int y = y0; y < std::min(height, y0 + kTile); ++y)
            for (int x = x0; x < std::min(width, x0 + kTile); ++x) order_.push_back(y * width + x);
    }
}

Vec2f PixelOrder::raster(int pixel, const Block& u) const {
    const int column = pixel % width_, row = pixel / width_;
    return {float(column + 0.5 + filter_.sample(u[0])), float(row + 0.5 + filter_.sample(u[1]))};
}

struct IndependentRun::Worker : ContributionSink {
    Worker(const Scene& scene, std::unique_ptr<SampleSource> s, bool techniqueImages)
        : source(std::move(s)),
          film(scene.sensor->width(), scene.sensor->height(), scene.filter),
          // A splat estimates the mean over the window, a pixel's sample its own pixel: one scale for both.
          pixelShare(film.pixels() / scene.sensor->windowArea()),
          featureEnergy(scene.features.names.size()) {
        if (techniqueImages) techniques = std::make_unique<TechniqueFilms>(film.width(), film.height(), scene.filter);
    }

    void add(const Contribution& c, uint32_t feature) override {
        if (!checkFinite(Cause::Contribution, c.value.x + c.value.y + c.value.z)) return;
        if (c.technique.t == 1) splats.add(c.raster, c.value);
        else sum += c.value;
        if (techniques) techniques->add(c, pixel);
        if (feature == kNone) return;
        const double energy = luminance(c.value) * (c.technique.t == 1 ? 1 : pixelShare);
        if (energy < FixedSum::kLargestTerm) featureEnergy[feature].add(energy);
    }

    void take(Worker& other) {
        film.take(other.film);
        nonFinite.take(other.nonFinite);
        if (techniques) techniques->take(*other.techniques);
        for (size_t i = 0; i < featureEnergy.size(); ++i) {
            featureEnergy[i].add(other.featureEnergy[i]);
            other.featureEnergy[i] = {};
        }
    }
    template <class Archive>
    void archive(Archive& a) {
        a(film, featureEnergy, nonFinite);
        if (techniques) a(*techniques);
    }

    std::unique_ptr<SampleSource> source;
    PrimaryVector u;
    Film film;
    SplatQueue splats{film};
    double pixelShare;
    std::unique_ptr<TechniqueFilms> techniques;
    std::vector<FixedSum> featureEnergy;
    NonFiniteLog nonFinite;
    // Of the sample being made:
    int pixel = 0;
    Spectrum sum{0.0};
};

IndependentRun::IndependentRun(const RunContext& context, const SourceMaker& makeSource, bool techniqueImages)
    : scene_(context.scene),
      key_(context.key),
      numbers_(context.key, 1),
      order_(context.scene.sensor->width(), context.scene.sensor->height(), context.scene.filter) {
    for (int i = 0; i < context.workers; ++i) workers_.push_back(std::make_unique<Worker>(scene_, makeSource(), techniqueImages));
}

IndependentRun::~IndependentRun() = default;

std::vector<MemoryPhase> IndependentRun::memory(const RunContext& context, const Keeps& keeps) {
    const double pixels = context.pixels(), depth = keeps.techniqueDepth;
    const double film = Film::bytes(pixels, keeps.samples, keeps.splats) + Film::countBytes(pixels);
    // k edges have k + 1 techniques that end on the sensor or see it, each with two images.
    const double images = depth * (depth + 3), techniques = images * Film::bytes(pixels, true, false);
    const auto phase = [&](int films) {
        MemoryNeeds parts = {filmsOf(films, film),
                             {"the order of pixels", pixels * sizeof(int), "a smaller film"}};
        if (images > 0) parts.push_back({fmt::format("{} films of techniques for each", images), films * techniques, "no technique_images or a smaller max_depth"});
        return parts;
    };
    // Between rounds of work one film has everything.
    MemoryPhase paused{phase(1), film + techniques};
    paused.parts.push_back({fmt::format("{} images of techniques", images), images * pixels * sizeof(Rgb), "no technique_images or a smaller max_depth"});
    return {{phase(context.workers)}, paused};
}

/// The numbers of a sample, whose pixel the worker then has.
Numbers IndependentRun::numbersOf(uint64_t sample, Worker& w, Random& random) const {
    w.u.clear();
    w.pixel = order_.pixel(sample);
    numbers_.begin(uint32_t(w.pixel), uint32_t(sample / uint64_t(order_.pixels())), w.source->options().techniques.walkFromLight(), w.u);
    return Numbers(w.u, random);
}

void IndependentRun::work(int worker, uint64_t begin, uint64_t end) {
    Worker& w = *workers_[size_t(worker)];
    for (uint64_t i = begin; i < end; ++i) {
        Random random(key_, 0, i);
        Numbers numbers = numbersOf(i, w, random);
        w.sum = Spectrum(0.0);
        takeCause();  // of what came before
        w.source->sample(order_.raster(w.pixel, numbers(NumberStream::Camera, 0)), numbers, w);
        if (const Cause cause = takeCause(); cause != Cause::None) [[unlikely]]
            w.nonFinite.add({.kind = NonFiniteEvent::Kind::Sample, .unit = i, .cause = name(cause)});
        w.film.countSample(w.pixel);
        w.film.addSample(w.pixel, w.sum);
    }
    w.splats.flush();
}

/// The first worker, which then has what all have made.
IndependentRun::Worker& IndependentRun::gathered() {
    Worker& first = *workers_[0];
    for (size_t i = 1; i < workers_.size(); ++i) first.take(*workers_[i]);
    return first;
}

Image IndependentRun::develop(uint64_t units) {
    return gathered().film.develop(scene_.sensor->windowArea() / double(units));
}

uint64_t IndependentRun::rays() const {
    uint64_t rays = raysBefore_;
    for (const auto& w : workers_) rays += w->source->rays();
    return rays;
}

void IndependentRun::report(uint64_t units, RenderStatistics& statistics) {
    statistics.samples = units;
    const uint64_t pixels = uint64_t(order_.pixels());
    const TechniqueSet& techniques = workers_[0]->source->options().techniques;
    if (techniques.walkFromCamera()) statistics.unsampledPixels = pixels - std::min(units, pixels);
    statistics.rays = rays();
    const Worker& all = gathered();
    statistics.nonFinite = all.nonFinite;
    statistics.nonFinite.count("deposit", all.film.nonFinite());
    for (const FixedSum& e : all.featureEnergy) statistics.featureEnergy.push_back(units > 0 ? e.value() / double(units) : 0);
    if (all.techniques) all.techniques->develop(all.film, scene_.sensor->windowArea() / double(units), statistics.extraImages);
}

void IndependentRun::save(ByteWriter& state) {
    uint64_t traced = rays();
    state(traced, gathered());
}

void IndependentRun::restore(ByteReader& state) {
    state(raysBefore_, gathered());
}

Json IndependentRun::replay(const NonFiniteEvent& event) {
    Worker& w = *workers_[0];
    Random random(key_, 0, event.unit);
    Numbers numbers = numbersOf(event.unit, w, random);
    Json json = {{"sample", event.unit}, {"pixel", {w.pixel % w.film.width(), w.pixel / w.film.width()}}};
    if (w.source->isGuided()) json["note"] = "this sampler also follows directions of its own, which are not shown";
    json.update(describeSample(scene_, w.source->options(), order_.raster(w.pixel, numbers(NumberStream::Camera, 0)), numbers));
    return json;
}

}  // namespace ulam
