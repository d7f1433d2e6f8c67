#pragma once
// Materials as BSDFs. Where pbrt's model is another, the nearest takes its place and the scene's substitutions say so.

#include <optional>

#include "core/scene/pbrt/textures.h"

namespace ulam::pbrt {

struct MaterialDefinition {
    std::string type, name;  ///< name: of MakeNamedMaterial, or empty
    Parameters parameters;
};

/// By index into the definitions, or by the name of one that may come later.
struct MaterialUse {
    size_t index = 0;
    std::string name;
    Place place;
};

class Materials {
public:
    Materials(Dictionary& dictionary, Textures& textures);

    /// The index by which shapes use it; 0 is the default material.
    size_t add(MaterialDefinition definition);

    /// A reference to the entry of the BSDF, for shapes of this parametrisation. `alpha`: cut out by a mask.
    Json use(const MaterialUse& use, Parametrization parametrization, const std::optional<Texture>& alpha);
    /// Does a texture cover it?
    bool isTextured(const MaterialUse& use);
    /// Entries for named materials that no shape uses: their mistakes are mistakes too.
    void addUnused();

private:
    struct Converted {
        std::string entry;
        bool textured = false;
    };
    struct Roughness {
        Texture u, v;
        bool isSmooth = false;
    };

    size_t indexOf(const MaterialUse& use) const;
    const Converted& convert(size_t index, Parametrization parametrization);
    Json bsdf(const MaterialDefinition& material);
    Json diffuse(const Parameters& p);
    Json coatedDiffuse(const Parameters& p);
    Json conductor(const Parameters& p);
    Json coatedConductor(const Parameters& p);
    Json metalBsdf(const Parameters& p, const std::string& prefix);
    Json dielectric(const Parameters& p);
    Json thinDielectric(const Parameters& p);
    Json mix(const Parameters& p);
    Json nothing(const Parameters& p);
    Json magenta() const;
    Json value(const Texture& texture);
    Roughness roughness(const Parameters& p, const std::string& prefix);
    void setRoughness(Json& bsdf, const Roughness& roughness);
    double coatAlpha(const Parameters& p, const Roughness& rough, std::string& difference);
    void nearest(const Parameters& p, const std::string& bsdf, const std::string& difference);

    Dictionary& dictionary_;
    Textures& textures_;
    std::vector<MaterialDefinition> definitions_;
    std::map<std::string, size_t> named_;
    std::map<std::pair<size_t, Parametrization>, Converted> converted_;
    std::map<std::string, std::string> masks_;  ///< entries by their text
    // Of the conversion at work:
    std::string entry_;
    Parametrization parametrization_ = Parametrization::Same;
    bool textured_ = false;
    int depth_ = 0;  ///< of mixtures in mixtures
};

}  // namespace ulam::pbrt
