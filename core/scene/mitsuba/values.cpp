#include "core/scene/mitsuba/values.h"

#include "core/image/srgb.h"

#include <charconv>
#include <cmath>

namespace ulam {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

bool usable(const SpectralCurve& curve) {
    for (size_t i = 1; i < curve.wavelengths.size(); ++i)
        if (!(curve.wavelengths[i - 1] < curve.wavelengths[i])) return false;
    return curve.wavelengths.size() >= 2;
}

}  // namespace

std::vector<std::string_view> words(std::string_view text) {
    constexpr std::string_view kSeparators = " \t\r\n,";
    std::vector<std::string_view> result;
    for (size_t begin = text.find_first_not_of(kSeparators); begin != text.npos;) {
        const size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
        result.push_back(text.substr(begin, end - begin));
        begin = text.find_first_not_of(kSeparators, end);
    }
    return result;
}

std::optional<double> parseNumber(std::string_view text) {
    const size_t begin = text.find_first_not_of(kBlanks);
    if (begin == text.npos) return {};
    text = text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

std::optional<std::vector<double>> parseNumbers(std::string_view text) {
    std::vector<double> numbers;
    for (const std::string_view word : words(text)) {
        const auto number = parseNumber(word);
        if (!number) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

std::optional<Json> parseRgb(std::string_view text, bool encoded) {
    const auto parts = words(text);
    if (parts.size() == 1 && parts[0].starts_with('#')) {
        uint32_t bits = 0;
        const std::string_view digits = parts[0].substr(1);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
        if (digits.size() != 6 || error != std::errc() || end != digits.data() + digits.size()) return {};
        const auto component = [bits](int shift) { return srgbToLinear((bits >> shift & 255) / 255.0); };
        return Json{component(16), component(8), component(0)};
    }
    auto numbers = parseNumbers(text);
    if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) return {};
    if (encoded)
        for (double& v : *numbers) v = srgbToLinear(v);
    return numbers->size() == 1 ? Json(numbers->front()) : Json(*numbers);
}

std::optional<SpectralCurve> parseCurve(std::string_view text) {
    SpectralCurve curve;
    for (const std::string_view word : words(text)) {
        const size_t colon = word.find(':');
        if (colon == word.npos) return {};
        const auto wavelength = parseNumber(word.substr(0, colon)), value = parseNumber(word.substr(colon + 1));
        if (!wavelength || !value) return {};
        curve.wavelengths.push_back(*wavelength);
        curve.values.push_back(*value);
    }
    if (!usable(curve)) return {};
    return curve;
}

std::optional<SpectralCurve> parseCurveFile(std::string_view text) {
    SpectralCurve curve;
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const auto numbers = parseNumbers(line.substr(0, line.find('#')));
        if (numbers && numbers->empty()) continue;
        if (!numbers || numbers->size() != 2) return {};
        curve.wavelengths.push_back((*numbers)[0]);
        curve.values.push_back((*numbers)[1]);
    }
    if (!usable(curve)) return {};
    return curve;
}

}  // namespace ulam
