#pragma once
// Generators: procedural scenes with difficulty knobs. A generator stands where a scene stands and expands to an
// ordinary scene dictionary; where a closed form exists it also knows the image.

#include "core/config/registry.h"
#include "core/image/image.h"
#include "core/scene/features.h"
#include "core/scene/sensors/perspective.h"

namespace ulam {

class Generator {
public:
    static const char* kind() { return "generator"; }
    virtual ~Generator() = default;

    /// The scene, sensor included, as a dictionary of ordinary plugins.
    virtual Json expand() const = 0;
    /// The places whose passing is counted; none by default.
    virtual Features features() const { return {}; }
    /// The exact image for a film with a box filter, or nothing where no closed form is known.
    virtual std::optional<Image> truth(const FilmSize&) const { return std::nullopt; }
    /// The exact share of the image's energy that passes each feature; empty where not known.
    virtual std::vector<double> featureShares() const { return {}; }
};

}  // namespace ulam

#define ULAM_REGISTER_GENERATOR(Type, name, summary) ULAM_REGISTER(::ulam::Generator, Type, name, summary)
