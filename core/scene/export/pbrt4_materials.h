#pragma once
// BSDFs and textures as pbrt-v4's directives.

#include <functional>

#include "core/scene/export/assets.h"
#include "core/scene/pbrt/textures.h"

namespace ulam {

class Pbrt4Materials {
public:
    using LeaveOut = std::function<void(const JsonNode&, std::string_view)>;
    using Resolve = std::function<JsonNode(const JsonNode&)>;

    /// `leaveOut` hears of what pbrt lacks, `resolve` follows references.
    Pbrt4Materials(ExportAssets& assets, LeaveOut leaveOut, Resolve resolve)
        : assets_(assets), leaveOut_(std::move(leaveOut)), resolve_(std::move(resolve)) {}

    struct Use {
        std::string material;  ///< the name of a material
        std::string alpha;     ///< a parameter of the shape, or empty
    };
    /// The material for a BSDF on shapes of this parametrisation.
    Use use(const JsonNode& bsdf, const std::string& name, pbrt::Parametrization parametrization);
    /// A diffuse surface of this reflectance.
    Use plain(double reflectance);
    /// Does a texture cover it?
    bool isTextured(const JsonNode& bsdf) const;

    /// The directives that make all materials and textures.
    const std::string& text() const { return text_; }
    /// How many BSDFs reflect on their back too because pbrt's do.
    int countTwosided() const { return twosided_; }

private:
    std::string material(const JsonNode& bsdf, const std::string& name);
    std::string directive(const JsonNode& bsdf);
    std::string value(const JsonNode& owner, const char* parameter, const char* name, bool isNumber,
                      const Json& otherwise);
    std::string texture(const JsonNode& node, bool isNumber);
    std::string roughness(const JsonNode& bsdf);
    std::string index(const JsonNode& bsdf, const char* otherwise);
    std::string metal(const JsonNode& bsdf);
    void needsOne(const JsonNode& bsdf, const char* parameter);

    ExportAssets& assets_;
    LeaveOut leaveOut_;
    Resolve resolve_;
    UniqueNames names_, textureNames_;
    std::string text_;
    std::map<std::string, std::string> made_;  ///< names by what was made
    pbrt::Parametrization parametrization_ = pbrt::Parametrization::Same;
    int twosided_ = 0;
    bool backMatters_ = true;
};

}  // namespace ulam
