#include "core/scene/bsdfs/principled_formulas.h"

namespace ulam {

template Spectrum Principled::eval(const Vec3d&, const Vec3d&, Lobe) const;
template double Principled::pdf(const Vec3d&, const Vec3d&, Lobe) const;

// Microfacets share their light between reflection and refraction, and Schlick's reflectance lies between 1 and that at normal
// incidence. Retro-reflection at most doubles the diffuse part. The sheen's albedo is largest at grazing angles, below 1. The
// clearcoat lacks the factor 1/cosθ of microfacets with their Fresnel reflectance.
double Principled::albedo() const {
    const double normal = std::pow((ior - 1) / (ior + 1), 2);
    return std::max(1.0, normal * maxComponent(tint())) + 2 * brdf() * maxComponent(baseColor) +
           sheen * (1 - metallic) * std::max(1.0, maxComponent(tint())) + clearcoat;
}

std::optional<ScatterSample> Principled::sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
    if (lobe != Lobe::Smooth || from.z == 0 || (from.z < 0 && !transmits)) return std::nullopt;
    const bool exterior = from.z > 0;
    const Vec3d arrived(from), w = onUpperSide(arrived);
    const Parts<double> parts(*this, arrived);
    const size_t part = chosenPart<3>({parts.diffuse, parts.clearcoat, parts.facets}, u[2]);
    if (part == 0) return ScatterSample{squareToCosineHemisphere(u[0], u[1]), Lobe::Smooth};
    const Vec3d m = part == 1 ? Clearcoat(*this).sample(u[0], u[1]) : microfacets().sampleVisible(w, u[0], u[1]);
    const double c = w.dot(m);
    if (!(c > 0)) return std::nullopt;
    const double refracted = parts.facets * (1 - interfaceReflectance(c, ior, exterior)) * refractedPart(exterior);
    const bool reflects = part == 1 || u[2] < 1 - refracted;
    const Vec3d to = reflects ? mirroredAt(w, m) : refractedAt(w, m, exterior ? 1 / ior : ior);
    if (reflects != (to.z > 0) || to.z == 0) return std::nullopt;
    return ScatterSample{Vec3f(to * (exterior ? 1 : -1)).normalized(), Lobe::Smooth};
}

bool Principled::invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
    // Of the same length, so that the half vector has the right direction at grazing angles too.
    const Vec3d w = Vec3d(from).normalized(), t = Vec3d(to).normalized();
    const InterfaceFacet<double> facet(ior, w, t, lobe);
    const bool exterior = w.z > 0;
    if (!facet.scatters || (!transmits && !(exterior && t.z > 0))) return false;
    const auto d = microfacets();
    const Clearcoat coat(*this);
    const Parts<double> parts(*this, w);
    const double refracted = parts.facets * (1 - facet.fresnel) * refractedPart(exterior), reflected = parts.facets - refracted;
    std::array<double, 4> densities{};
    if (facet.reflects)
        densities = {parts.diffuse * cosineHemispherePdf(t.z), parts.clearcoat * coat.pdf(facet),
                     reflected * roughReflectionPdf(d, onUpperSide(w), facet.m), 0};
    else
        densities[3] = refracted * roughRefractionPdf(d, facet, onUpperSide(w), index(t.z > 0));
    const auto part = invertPart<4>({parts.diffuse, parts.clearcoat, reflected, refracted}, densities, u[2]);
    if (!part) return false;
    const Sample2 s = *part == 0   ? cosineHemisphereToSquare(to)
                      : *part == 1 ? coat.invert(facet.m)
                                   : d.invertVisible(onUpperSide(w), facet.m);
    u[0] = s.u;
    u[1] = s.v;
    return true;
}

}  // namespace ulam
