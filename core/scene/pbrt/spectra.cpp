#include "core/scene/pbrt/spectra.h"

#include <fmt/format.h>

#include <array>

#include "core/base/file.h"
#include "core/config/suggest.h"
#include "core/scene/bsdfs/metals.h"
#include "core/scene/loading/scene_file.h"
#include "core/scene/loading/spectra.h"
#include "core/scene/mitsuba/values.h"

namespace ulam::pbrt {
namespace {

struct Glass {
    std::string_view name;
    double ior;
};

// Refractive indices at 587.6 nm (Schott's catalogue of optical glass); F5 to F11 are pbrt's names for SF5 to SF11.
constexpr std::array kGlasses{Glass{"glass-BK7", 1.5168},    Glass{"glass-BAF10", 1.67003},
                              Glass{"glass-FK51A", 1.48656}, Glass{"glass-LASF9", 1.85025},
                              Glass{"glass-F5", 1.67271},    Glass{"glass-F10", 1.72828},
                              Glass{"glass-F11", 1.78472}};

Spectrum spectrum(const Imath::V3d& rgb) {
    return {rgb.x, rgb.y, rgb.z};
}

SpectralCurve curveOf(const Parameter& parameter, const Dictionary& dictionary) {
    std::optional<SpectralCurve> curve;
    if (!parameter.texts.empty()) {
        if (parameter.texts.size() != 1)
            refuse(parameter.place, fmt::format("{} is one spectrum", inQuotes(parameter.name)));
        const std::string& name = parameter.texts[0];
        const SceneFile file = findSceneFile(dictionary.folder, name);
        if (!file.refusal.empty()) refuse(parameter.place, file.refusal, file.hint);
        std::error_code error;
        if (!std::filesystem::exists(file.path, error))
            refuse(parameter.place,
                   fmt::format("{} is neither a spectrum that is known here nor a file", inQuotes(name)));
        curve = parseCurveFile(readFile(file.path, kMaxJsonBytes));
    } else {
        curve.emplace();
        for (size_t i = 0; i + 1 < parameter.numbers.size(); i += 2) {
            curve->wavelengths.push_back(parameter.numbers[i]);
            curve->values.push_back(parameter.numbers[i + 1]);
        }
        const auto& w = curve->wavelengths;
        const bool ascending = std::adjacent_find(w.begin(), w.end(), std::greater_equal<>()) == w.end();
        if (parameter.numbers.size() % 2 != 0 || w.size() < 2 || !ascending) curve.reset();
    }
    if (!curve)
        refuse(parameter.place,
               fmt::format("{} is not a spectrum: two or more wavelengths, ascending, each with its value",
                           inQuotes(parameter.name)));
    return *curve;
}

Spectrum rgbOf(const Parameters& owner, const Parameter& parameter) {
    if (parameter.numbers.size() != 3)
        refuse(parameter.place, fmt::format("{} of {} is one colour", inQuotes(parameter.name), owner.owner()));
    return {parameter.numbers[0], parameter.numbers[1], parameter.numbers[2]};
}

Spectrum blackbodyOf(const Parameters& owner, const Parameter& parameter) {
    if (parameter.numbers.size() != 1 || !(parameter.numbers[0] >= 100 && parameter.numbers[0] <= 1e6))
        refuse(parameter.place, fmt::format("{} of {} is one temperature from 100 to 1000000 K",
                                            inQuotes(parameter.name), owner.owner()));
    return spectrum(blackbodyRgb(parameter.numbers[0]));
}

Spectrum unitLuminance(const Spectrum& colour, const Parameter& parameter) {
    if (!(luminance(colour) > 0))
        refuse(parameter.place, fmt::format("the spectrum of {} holds no visible light", inQuotes(parameter.name)));
    return colour / luminance(colour);
}

/// "Au" in "metal-Au-eta"; empty where it is no such name.
std::string metalIn(const Parameter* parameter, std::string_view ending) {
    if (!parameter || parameter->texts.size() != 1) return {};
    std::string_view name = parameter->texts[0];
    if (!name.starts_with("metal-") || !name.ends_with(ending)) return {};
    name.remove_prefix(6);
    name.remove_suffix(ending.size());
    return std::string(name);
}

}  // namespace

Spectrum reflectance(const Parameters& owner, const Parameter& parameter, const Dictionary& dictionary) {
    if (parameter.type == "rgb") return rgbOf(owner, parameter);
    return spectrum(toRgb(curveOf(parameter, dictionary), SpectrumUse::Reflectance));
}

Spectrum light(const Parameters& owner, std::string_view name, const Dictionary& dictionary) {
    const Parameter* parameter = owner.find(name, {"rgb", "spectrum", "blackbody"});
    if (!parameter) return Spectrum(1.0);
    if (parameter->type == "rgb") return rgbOf(owner, *parameter);
    if (parameter->type == "blackbody") return unitLuminance(blackbodyOf(owner, *parameter), *parameter);
    if (parameter->texts == std::vector<std::string>{"stdillum-D65"}) return Spectrum(1.0);
    // Illuminant A is defined as a black body.
    if (parameter->texts == std::vector<std::string>{"stdillum-A"})
        return unitLuminance(spectrum(blackbodyRgb(2856)), *parameter);
    return unitLuminance(spectrum(toRgb(curveOf(*parameter, dictionary), SpectrumUse::Emission)), *parameter);
}

double index(const Parameters& owner, std::string_view name, double otherwise, Dictionary& dictionary) {
    const Parameter* parameter = owner.find(name, {"float", "spectrum"});
    if (!parameter) return otherwise;
    if (parameter->type == "float") return owner.number(name, otherwise);
    dictionary.substitute(fmt::format("{} of {} at {} is one number for all colours: light is not dispersed",
                                      inQuotes(name), owner.owner(), parameter->place.text()));
    std::vector<std::string> names;
    if (parameter->texts.size() == 1)
        for (const Glass& glass : kGlasses) {
            if (glass.name == parameter->texts[0]) return glass.ior;
            names.emplace_back(glass.name);
        }
    if (parameter->texts.size() == 1 && parameter->texts[0].starts_with("glass-"))
        unknownName("glass", parameter->texts[0], names, parameter->place.text());
    return toRgb(curveOf(*parameter, dictionary), SpectrumUse::Unbounded).y;
}

Json metal(const Parameters& owner, const std::string& prefix, const Dictionary& dictionary) {
    const Parameter *eta = owner.find(prefix + "eta", {"rgb", "spectrum"}),
                    *k = owner.find(prefix + "k", {"rgb", "spectrum"});
    if (!eta && !k) return {{"material", "Cu"}};
    const std::string a = eta ? metalIn(eta, "-eta") : "Cu", b = k ? metalIn(k, "-k") : "Cu";
    if (!a.empty() && a == b && findMetal(a)) return {{"material", a}};
    const auto constant = [&](const Parameter* parameter, const std::string& name, bool isEta) {
        if (!name.empty()) {
            const Metal* known = findMetal(name);
            if (!known && parameter) unknownName("metal", name, metalNames(), parameter->place.text());
            return colourJson(isEta ? known->eta : known->k);
        }
        if (parameter->type == "rgb") return colourJson(rgbOf(owner, *parameter));
        return colourJson(spectrum(toRgb(curveOf(*parameter, dictionary), SpectrumUse::Unbounded)));
    };
    return {{"eta", constant(eta, a, true)}, {"k", constant(k, b, false)}};
}

}  // namespace ulam::pbrt
