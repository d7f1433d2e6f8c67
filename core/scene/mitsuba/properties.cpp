#include "core/scene/mitsuba/properties.h"

#include "core/config/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ulam {
namespace {

Json colour(const Imath::V3d& rgb) { return {rgb.x, rgb.y, rgb.z}; }

class Property {
public:
    Property(const pugi::xml_node& element, const PropertyContext& context) : element_(element), context_(context) {}

    Json read() const {
        struct Reader {
            const char* tag;
            Json (Property::*read)() const;
            bool onlyOld;
        };
        static constexpr std::array<Reader, 12> kReaders{{{"float", &Property::number, false},
                                                          {"integer", &Property::integer, false},
                                                          {"boolean", &Property::boolean, false},
                                                          {"string", &Property::string, false},
                                                          {"point", &Property::vector, false},
                                                          {"vector", &Property::vector, false},
                                                          {"rgb", &Property::rgb, false},
                                                          {"spectrum", &Property::spectrum, false},
                                                          {"transform", &Property::transform, false},
                                                          {"srgb", &Property::srgb, true},
                                                          {"blackbody", &Property::blackbody, true},
                                                          {"color", &Property::rgb, true}}};
        std::vector<std::string> names;
        for (const Reader& reader : kReaders) {
            if (reader.onlyOld && !context_.old) continue;
            if (element_.name() == std::string_view(reader.tag)) return (this->*reader.read)();
            names.emplace_back(reader.tag);
        }
        throw PropertyError{fmt::format("there is no element <{}>", printable(element_.name())), didYouMean(element_.name(), names)};
    }

private:
    std::string text(const char* attribute = "value") const {
        if (!element_.attribute(attribute))
            throw PropertyError{fmt::format("<{}> has no attribute {}", element_.name(), inQuotes(attribute)), {}};
        return element_.attribute(attribute).value();
    }
    [[noreturn]] void refuse(const std::string& what, const std::string& found) const {
        throw PropertyError{fmt::format("expected {}, found {}", what, inQuotes(found)), {}};
    }
    double numberOf(const std::string& value) const {
        const auto number = parseNumber(value);
        if (!number) refuse("a number", value);
        return *number;
    }

    Json number() const { return numberOf(text()); }
    Json integer() const {
        const double value = numberOf(text());
        if (value != std::floor(value) || std::abs(value) > 9e15) refuse("a whole number", text());
        return int64_t(value);
    }
    Json boolean() const {
        std::string value = text();
        std::transform(value.begin(), value.end(), value.begin(), [](unsigned char c) { return char(std::tolower(c)); });
        if (value != "true" && value != "false") refuse("\"true\" or \"false\"", value);
        return value == "true";
    }
    Json string() const { return text(); }
    Json vector() const { return components(element_, {}); }
    Json rgb() const { return rgbOf(false); }
    Json srgb() const { return rgbOf(true); }
    Json rgbOf(bool encoded) const {
        const auto value = parseRgb(text(), encoded);
        if (!value) refuse("one or three numbers, or #rrggbb", text());
        return *value;
    }

    Json spectrum() const {
        const std::string value = text();
        if (const auto curve = parseCurve(value)) return colour(toRgb(*curve, use()));
        const auto numbers = parseNumbers(value);
        if (numbers && numbers->size() == 1) {
            // The same power at all wavelengths; as a reflectance that is grey.
            if (!context_.emits) return numbers->front();
            return colour(toRgb({{300, 900}, {1, 1}}, use()) * numbers->front());
        }
        if (numbers && numbers->size() == 3 && context_.old) return Json(*numbers);
        refuse("a number, or two or more wavelengths and values such as \"400:0.1, 700:0.5\"", value);
    }
    SpectrumUse use() const {
        static constexpr std::array kUnbounded{"eta", "k", "int_ior", "ext_ior"};
        if (context_.emits) return SpectrumUse::Emission;
        return std::find(kUnbounded.begin(), kUnbounded.end(), context_.name) != kUnbounded.end() ? SpectrumUse::Unbounded : SpectrumUse::Reflectance;
    }

    Json blackbody() const {
        std::string kelvin = text("temperature");
        if (kelvin.ends_with('K') || kelvin.ends_with('k')) kelvin.pop_back();
        const double temperature = numberOf(kelvin);
        if (!(temperature >= 1 && temperature <= 1e6)) refuse("a temperature from 1 to 1000000 K", text("temperature"));
        return colour(blackbodyRgb(temperature) * (element_.attribute("scale") ? numberOf(text("scale")) : 1));
    }

    /// x, y, z, or all three in `value`. Without `otherwise` all must be there.
    Json components(const pugi::xml_node& element, std::optional<double> otherwise) const {
        const std::string value = element.attribute("value").value();
        if (!value.empty()) {
            const auto numbers = parseNumbers(value);
            if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) refuse("one or three numbers", value);
            return numbers->size() == 3 ? Json(*numbers) : Json(std::vector<double>(3, numbers->front()));
        }
        Json result = Json::array();
        for (const char* axis : {"x", "y", "z"}) {
            const std::string component = element.attribute(axis).value();
            if (component.empty() && !otherwise) throw PropertyError{fmt::format("<{}> has no attribute {}", element.name(), inQuotes(axis)), {}};
            result.push_back(component.empty() ? *otherwise : numberOf(component));
        }
        return result;
    }

    Json transform() const {
        Json steps = Json::array();
        for (const pugi::xml_node& child : element_.children())
            if (child.type() == pugi::node_element) steps.push_back(step(child));
        if (steps.empty()) steps.push_back({{"type", "translate"}, {"value", {0, 0, 0}}});
        return steps;
    }
    Json step(const pugi::xml_node& element) const {
        const std::string tag = element.name();
        const auto given = [&](const char* attribute) { return std::string(element.attribute(attribute).value()); };
        if (tag == "translate") return {{"type", tag}, {"value", components(element, 0)}};
        if (tag == "scale") return {{"type", tag}, {"value", components(element, 1)}};
        if (tag == "rotate") return {{"type", tag}, {"axis", components(element, 0)}, {"angle", numberOf(given("angle"))}};
        if (tag == "lookat" || (context_.old && tag == "lookAt")) {
            Json result = {{"type", "lookat"}};
            for (const char* name : {"origin", "target", "up"}) {
                if (name == std::string_view("up") && given(name).empty()) continue;
                const auto numbers = parseNumbers(given(name));
                if (!numbers || numbers->size() != 3) refuse(fmt::format("three numbers for {}", inQuotes(name)), given(name));
                result[name] = *numbers;
            }
            return result;
        }
        if (tag == "matrix") {
            const auto numbers = parseNumbers(given("value"));
            if (!numbers || (numbers->size() != 16 && numbers->size() != 9)) refuse("9 or 16 numbers", given("value"));
            const std::vector<double>& m = *numbers;
            if (m.size() == 16) return {{"type", tag}, {"value", m}};
            return {{"type", tag}, {"value", {m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, 0, 0, 0, 1}}};
        }
        throw PropertyError{fmt::format("there is no transformation <{}>", printable(tag)), didYouMean(tag, {"translate", "rotate", "scale", "lookat", "matrix"})};
    }

    const pugi::xml_node& element_;
    const PropertyContext& context_;
};

}  // namespace

Json readProperty(const pugi::xml_node& element, const PropertyContext& context) { return Property(element, context).read(); }

Json readSpectrumFile(std::string_view text, const PropertyContext& context) {
    const auto curve = parseCurveFile(text);
    if (!curve) throw PropertyError{"the file of the spectrum does not hold lines of a wavelength and a value, wavelengths ascending", {}};
    return colour(toRgb(*curve, context.emits ? SpectrumUse::Emission : SpectrumUse::Reflectance));
}

std::optional<Json> plainSpectrum(const Json& plugin, bool emits) {
    const auto number = [&](const char* name, double otherwise) {
        return plugin.contains(name) && plugin[name].is_number() ? plugin[name].get<double>() : otherwise;
    };
    const std::string type = plugin["type"];
    if (type == "uniform") return number("value", 1);
    if (type == "d65") return number("scale", 1);
    if (type == "srgb" && plugin.contains("color")) return plugin["color"];
    if (type == "blackbody") {
        const double temperature = number("temperature", 5000);
        if (!(temperature >= 1 && temperature <= 1e6)) throw PropertyError{"a black body's temperature is from 1 to 1000000 K", {}};
        return colour(blackbodyRgb(temperature) * number("scale", 1));
    }
    if (type != "regular" && type != "irregular") return {};
    const auto list = [&](const char* name) {
        const auto numbers = plugin.contains(name) && plugin[name].is_string() ? parseNumbers(plugin[name].get<std::string>()) : std::nullopt;
        if (!numbers || numbers->size() < 2) throw PropertyError{fmt::format("{} needs two or more {}", type, name), {}};
        return *numbers;
    };
    SpectralCurve curve{{}, list("values")};
    if (type == "irregular") curve.wavelengths = list("wavelengths");
    else
        for (size_t i = 0; i < curve.values.size(); ++i)
            curve.wavelengths.push_back(std::lerp(number("wavelength_min", 360), number("wavelength_max", 830), double(i) / double(curve.values.size() - 1)));
    if (curve.wavelengths.size() != curve.values.size() || !std::is_sorted(curve.wavelengths.begin(), curve.wavelengths.end(), std::less_equal<>()))
        throw PropertyError{fmt::format("{} needs as many wavelengths as values, ascending", type), {}};
    return colour(toRgb(curve, emits ? SpectrumUse::Emission : SpectrumUse::Reflectance));
}

}  // namespace ulam
