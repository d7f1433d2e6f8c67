#pragma once
// A run of independent samples: path tracing, particle tracing, bidirectional path tracing and whatever else makes an
// image from samples that know nothing of each other, but for a pixel's, whose numbers are spread evenly (pixel_numbers.h).

#include "core/image/film.h"
#include "core/path/bidirectional.h"
#include "core/render/pixel_numbers.h"
#include "core/render/sampler.h"

namespace ulam {

/// Takes the contributions of a sample. t = 1 is splatted where it says; the others belong to the sample's pixel.
class ContributionSink {
public:
    virtual void add(const Contribution& contribution, uint32_t feature) = 0;

protected:
    ~ContributionSink() = default;
};

/// One worker's way of making samples.
class SampleSource {
public:
    virtual ~SampleSource() = default;
    virtual void sample(const Vec2f& raster, Numbers& numbers, ContributionSink& sink) = 0;
    /// What it takes of bidirectional path tracing's samples with the same numbers.
    virtual const BidirectionalOptions& options() const = 0;
    /// Directions that are not the BSDF's.
    virtual bool isGuided() const { return false; }
    virtual uint64_t rays() const = 0;
};

/// Bidirectional samples with any set of techniques.
std::unique_ptr<SampleSource> makeBidirectionalSource(const Scene& scene, const BidirectionalOptions& options);

/// Which pixel a sample belongs to, and where in it. Every pixel gets its n-th sample before any gets its (n+1)-th. Tiles
/// follow each other in an order that spreads over the image, so that a pass which time cuts short covers it evenly.
class PixelOrder {
public:
    PixelOrder(int width, int height, const ReconstructionFilter& filter);

    int pixels() const { return int(order_.size()); }
    int pixel(uint64_t sample) const { return order_[sample % order_.size()]; }
    /// Raster position for a pixel, its offset from the centre distributed as the filter.
    Vec2f raster(int pixel, const Block& u) const;

private:
    int width_;
    std::vector<int> order_;
    ReconstructionFilter filter_;
};

class IndependentRun : public SamplerRun {
public:
    using SourceMaker = std::function<std::unique_ptr<SampleSource>()>;

    /// `techniqueImages`: also keep an image per technique, weighted and unweighted.
    IndependentRun(const RunContext& context, const SourceMaker& makeSource, bool techniqueImages = false);
    ~IndependentRun() override;

    struct Keeps {
        bool samples = true, splats = false;  ///< contributions that belong to pixels, and others
        int techniqueDepth = 0;               ///< longest path of the techniques that have images; 0: none have
    };
    /// For Sampler::memory.
    static std::vector<MemoryPhase> memory(const RunContext& context, const Keeps& keeps);

    uint64_t chunk() const override { return 256; }
    void work(int worker, uint64_t begin, uint64_t end) override;
    Image develop(uint64_t units) override;
    uint64_t rays() const override;
    void report(uint64_t units, RenderStatistics& statistics) override;
    void save(ByteWriter& state) override;
    void restore(ByteReader& state) override;
    Json replay(const NonFiniteEvent& event) override;

private:
    struct Worker;

    Numbers numbersOf(uint64_t sample, Worker& worker, Random& random) const;
    Worker& gathered();

    const Scene& scene_;
    RandomKey key_;
    PixelNumbers numbers_;
    PixelOrder order_;
    std::vector<std::unique_ptr<Worker>> workers_;
    uint64_t raysBefore_ = 0;  ///< traced before the run was restored
};

}  // namespace ulam
