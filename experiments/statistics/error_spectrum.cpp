#include "experiments/statistics/error_spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

/// |DFT|² / number of pixels, at the frequencies of each axis in the order of the transform.
std::vector<double> power(const ErrorImage& error) {
    const auto width = static_cast<std::size_t>(error.width), height = static_cast<std::size_t>(error.height);
    Eigen::FFT<double> fft;
    std::vector<std::complex<double>> spectrum(width * height), line, transformed;
    for (std::size_t y = 0; y < height; ++y) {
        line.assign(error.values.begin() + static_cast<std::ptrdiff_t>(y * width),
                    error.values.begin() + static_cast<std::ptrdiff_t>((y + 1) * width));
        fft.fwd(transformed, line);
        std::ranges::copy(transformed, spectrum.begin() + static_cast<std::ptrdiff_t>(y * width));
    }
    line.resize(height);
    std::vector<double> squares(width * height);
    for (std::size_t x = 0; x < width; ++x) {
        for (std::size_t y = 0; y < height; ++y) line[y] = spectrum[y * width + x];
        fft.fwd(transformed, line);
        for (std::size_t y = 0; y < height; ++y)
            squares[y * width + x] = std::norm(transformed[y]) / static_cast<double>(width * height);
    }
    return squares;
}

/// In cycles a pixel; the upper half of a transform has the negative frequencies.
double frequency(int index, int size) {
    return static_cast<double>(std::min(index, size - index)) / size;
}

/// The frequencies of a transform other than 0, by bin.
struct Bins {
    std::vector<std::size_t> binOf;     // per frequency; those of frequency 0 are not used
    std::vector<double> sizes, centres;  // number and mean of the frequencies

    Bins(int width, int height) : binOf(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        const double lowest = 1.0 / std::max(width, height);
        std::vector<double> counts, sums;
        std::vector<std::size_t> raw(binOf.size());
        for (std::size_t i = 1; i < raw.size(); ++i) {
            const double f = distance(i, width, height);
            // Bins start at the lowest frequency; rounding must not put it below.
            raw[i] = static_cast<std::size_t>(std::floor(kBinsPerOctave * std::log2(f / lowest) + 1e-9));
            counts.resize(std::max(counts.size(), raw[i] + 1));
            sums.resize(counts.size());
            counts[raw[i]] += 1;
            sums[raw[i]] += f;
        }
        std::vector<std::size_t> number(counts.size());
        for (std::size_t b = 0; b < counts.size(); ++b) {
            if (counts[b] == 0) continue;
            number[b] = sizes.size();
            sizes.push_back(counts[b]);
            centres.push_back(sums[b] / counts[b]);
        }
        for (std::size_t i = 1; i < raw.size(); ++i) binOf[i] = number[raw[i]];
    }

    static double distance(std::size_t i, int width, int height) {
        const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        return std::hypot(frequency(x, width), frequency(y, height));
    }
};

}  // namespace

ErrorSpectrum errorSpectrum(std::span<const ErrorImage> errors, int channels) {
    const ErrorImage& first = errors.front();
    for (const ErrorImage& e : errors) {
        if (e.width == first.width && e.height == first.height && e.values.size() == first.values.size()) continue;
        fail(ExitCode::InvalidConfig, "error spectrum: expected images of {} x {} pixels, found {} x {}", first.width,
             first.height, e.width, e.height);
    }
    const Bins bins(first.width, first.height);
    const std::size_t runs = errors.size() / static_cast<std::size_t>(channels);
    std::vector<std::vector<double>> densities(bins.sizes.size(), std::vector<double>(runs));  // [bin][run]
    ErrorSpectrum spectrum{.counts = bins.sizes, .frequencies = bins.centres, .mean = {}, .low = {}, .high = {}};
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const std::size_t run = i / static_cast<std::size_t>(channels);
        const std::vector<double> p = power(errors[i]);
        for (std::size_t k = 1; k < p.size(); ++k)
            densities[bins.binOf[k]][run] += p[k] / (bins.sizes[bins.binOf[k]] * channels);
        spectrum.brightness += p[0] / static_cast<double>(p.size() * errors.size());
    }
    for (const std::vector<double>& density : densities) {
        spectrum.mean.push_back(mean(density));
        spectrum.low.push_back(quantile(density, kSpectrumBand[0]));
        spectrum.high.push_back(quantile(density, kSpectrumBand[1]));
    }
    return spectrum;
}

}  // namespace ulam::statistics
