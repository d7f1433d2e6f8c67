#pragma once
// The error spectrum ensemble (Celarek, Jakob, Wimmer and Lehtinen 2019, "Quantifying the Error of Light Transport
// Algorithms"): the power of error images by frequency, over many runs. It tells independent noise, which is flat, from
// errors that neighbours share, which lie at low frequencies: blobs where chains were caught, and brightness.

#include <span>
#include <vector>

namespace ulam::statistics {

/// An error image, row by row.
struct ErrorImage {
    std::span<const double> values;
    int width, height;
};

/// Spectral densities in bins of the distance from frequency 0. Independent errors of variance v have density v at every
/// frequency.
struct ErrorSpectrum {
    std::vector<double> counts;           ///< frequencies in each bin
    std::vector<double> frequencies;      ///< mean of each bin, in cycles a pixel, rising; the corners reach √½
    std::vector<double> mean, low, high;  ///< density over the runs: mean, and the quantiles of kSpectrumBand
    /// Mean over the runs of (mean error)², what frequency 0 has of the mean square: with the sum of counts · mean over the
    /// number of pixels it is the mean square.
    double brightness = 0;
};

inline constexpr double kSpectrumBand[2] = {0.05, 0.95};
/// Bins a factor of two in frequency has.
inline constexpr double kBinsPerOctave = 3;

/// Of images of one size, at least one; those of one run follow each other, `channels` of each. Throws InvalidConfig where
/// sizes differ.
ErrorSpectrum errorSpectrum(std::span<const ErrorImage> errors, int channels);

}  // namespace ulam::statistics
