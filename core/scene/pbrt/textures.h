#pragma once
// Named textures and parameters that may be textured. What Ulam can hold is a constant, a picture with a factor, or a
// checkerboard of two constants; `scale` and `mix` are worked out where that gives one of these.

#include <map>
#include <memory>

#include "core/scene/pbrt/spectra.h"

namespace ulam::pbrt {

struct Texture {
    enum class Kind { Constant, Picture, Checkerboard };
    Kind kind = Kind::Constant;
    Spectrum first{1, 1, 1};   ///< the constant; a picture's factor; the checkerboard's colour at the origin
    Spectrum second{0, 0, 0};  ///< the checkerboard's other colour
    Json plugin;               ///< of a picture: filename and the like
    Matrix4 toUv;              ///< from pbrt's surface parameters to the plugin's
    std::string name = "texture";
    Place place;

    bool isConstant() const { return kind == Kind::Constant; }
};

/// Surface parameters of shapes here as pbrt has them; they differ by an affine map.
enum class Parametrization { Same, Sphere, Disk };  // `Same` is the first

/// From the parameters of such a shape here to pbrt's; points (u, v, 0) are rows.
const Matrix4& toPbrt(Parametrization parametrization);

class Textures {
public:
    explicit Textures(Dictionary& dictionary) : dictionary_(dictionary) {}

    /// A Texture directive.
    void define(const std::string& name, const std::string& valueType, const std::string& type,
                const Parameters& parameters);

    /// A parameter that may be a constant or name a texture; `number`: it has no colour.
    Texture colour(const Parameters& owner, std::string_view name, const Spectrum& otherwise) const;
    Texture number(const Parameters& owner, std::string_view name, double otherwise) const;

    /// What stands in a dictionary: a constant, or a reference to an entry, which is added.
    Json use(const Texture& texture, Parametrization parametrization);

private:
    using Named = std::map<std::string, Texture>;

    Texture named(const Named& textures, const Parameter& parameter) const;
    Texture read(const std::string& type, bool isNumber, const Parameters& parameters) const;
    Texture value(const Parameters& owner, std::string_view name, bool isNumber, double otherwise) const;
    Texture picture(const Parameters& parameters, bool isNumber) const;
    Texture checkerboard(const Parameters& parameters, bool isNumber) const;
    Texture scaled(const Parameters& parameters, bool isNumber) const;
    Texture mixed(const Parameters& parameters, bool isNumber) const;
    Texture unsupported(const std::string& what, const Parameters& parameters) const;
    Texture product(const Texture& a, const Texture& b, const Parameters& parameters) const;

    Dictionary& dictionary_;
    Named colours_, numbers_;
    std::map<std::string, std::string> entries_;  ///< by the plugin's text
};

}  // namespace ulam::pbrt
