#pragma once
// Parameters that BSDFs of one family share, with Mitsuba 3's names and defaults.

#include "core/base/error.h"
#include "core/base/vector.h"
#include "core/scene/bsdfs/metals.h"

#include <string>

namespace ulam {

/// conductor, roughconductor.
struct MetalParameters {
    std::string material = "none";
    Spectrum eta{0, 0, 0}, k{1, 1, 1}, specularReflectance{1, 1, 1};
    template <class V>
    void describe(V& v) {
        v("material", material, {.help = "a substance, instead of eta and k; none: a perfect mirror, unless they are given", .choices = metalNames()});
        v("eta", eta, {.help = "real part of the index of refraction", .min = 0, .max = 1e3});
        v("k", k, {.help = "imaginary part of the index of refraction", .min = 0, .max = 1e3});
        v("specular_reflectance", specularReflectance, {.help = "factor on the Fresnel reflectance", .min = 0, .max = 1});
    }
};

/// dielectric, roughdielectric, thindielectric.
struct InterfaceParameters {
    double intIor = 1.5046, extIor = 1.000277;
    Spectrum specularReflectance{1, 1, 1}, specularTransmittance{1, 1, 1};
    template <class V>
    void describe(V& v) {
        v("int_ior", intIor, {.help = "index of refraction inside, or of the pane; default BK7 glass", .min = 0.1, .max = 10});
        v("ext_ior", extIor, {.help = "index of refraction outside; default air", .min = 0.1, .max = 10});
        v("specular_reflectance", specularReflectance, {.help = "factor on the reflected light", .min = 0, .max = 1});
        v("specular_transmittance", specularTransmittance, {.help = "factor on the transmitted light", .min = 0, .max = 1});
    }
};

/// plastic, roughplastic.
struct CoatParameters {
    Spectrum diffuseReflectance{0.5, 0.5, 0.5}, specularReflectance{1, 1, 1};
    bool nonlinear = false;
    double intIor = 1.49, extIor = 1.000277;
    template <class V>
    void describe(V& v) {
        v("diffuse_reflectance", diffuseReflectance, {.help = "of the base", .min = 0, .max = 1});
        v("specular_reflectance", specularReflectance, {.help = "factor on the coat's reflection", .min = 0, .max = 1});
        v("nonlinear", nonlinear, {.help = "colours saturate by scattering between base and coat"});
        v("int_ior", intIor, {.help = "index of refraction of the coat; default polypropylene", .min = 0.1, .max = 10});
        v("ext_ior", extIor, {.help = "index of refraction outside; default air", .min = 0.1, .max = 10});
    }
};

/// phong, ward.
struct GlossParameters {
    Spectrum diffuseReflectance{0.5, 0.5, 0.5}, specularReflectance{0.2, 0.2, 0.2};
    template <class V>
    void describe(V& v) {
        v("diffuse_reflectance", diffuseReflectance, {.help = "of the base", .min = 0, .max = 1});
        v("specular_reflectance", specularReflectance, {.help = "of the gloss; with the base's at most 1", .min = 0, .max = 1});
    }
    /// The base's, once the sum is known to conserve energy.
    const Spectrum& diffuse(const char* plugin) const {
        const double sum = maxComponent(diffuseReflectance + specularReflectance);
        if (sum > 1 + 1e-9)
            fail(ExitCode::InvalidConfig, "{}: diffuse_reflectance and specular_reflectance add up to {:g}, more than 1",
                 plugin, sum);
        return diffuseReflectance;
    }
};
/// Probability of sampling the gloss: its part of the albedo.
inline double glossShare(const Spectrum& diffuse, const Spectrum& specular) {
    const double gloss = specular.x + specular.y + specular.z, total = gloss + diffuse.x + diffuse.y + diffuse.z;
    return total > 0 ? gloss / total : 0;
}

}  // namespace ulam
