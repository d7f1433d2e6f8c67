#pragma once
// spot: a point that shines into a cone (Mitsuba 3 `spot`): full intensity up to beam_width from the axis, from there
// falling linearly with the angle to nothing at cutoff_angle.

#include "core/scene/emitters/delta_position.h"

namespace ulam {

struct SpotEmitter : DeltaPosition {
    struct Parameters {
        Spectrum intensity{1, 1, 1};
        double cutoffAngle = 20, beamWidth = 0;
        template <class V>
        void describe(V& v) {
            v("intensity", intensity, {.help = "radiant intensity on the axis", .unit = "W/sr", .min = 0});
            v("cutoff_angle", cutoffAngle, {.help = "angle to the axis beyond which there is no light", .unit = "degrees", .min = 0, .max = 180, .minExclusive = true});
            v("beam_width", beamWidth, {.help = "angle to the axis up to which the intensity is full; 0: three quarters of cutoff_angle", .unit = "degrees", .min = 0, .max = 180});
        }
    };
    SpotEmitter(const Parameters& p, const Vec3f& place, const Vec3f& direction)
        : DeltaPosition{place, Vertex::Kind::Point},
          intensity(p.intensity),
          frame(direction),
          cutoff(p.cutoffAngle * kPi / 180),
          beam((p.beamWidth > 0 ? p.beamWidth : 0.75 * p.cutoffAngle) * kPi / 180) {}

    Spectrum intensity;
    Frame frame;          ///< n: the axis
    double cutoff, beam;  ///< radians

    /// ∫ intensity dω: full over the beam, and the ramp by parts.
    double power(const EmissionContext&) const {
        const double whole = cutoff > beam ? 1 - (std::sin(cutoff) - std::sin(beam)) / (cutoff - beam) : 1 - std::cos(cutoff);
        return luminance(intensity) * 2 * kPi * whole;
    }

    /// Uniform over the cone.
    EmittedRay sampleDirection(const EmissionContext&, const Vertex&, const Block& u) const {
        const double lost = u[0] * (1 - std::cos(cutoff)), z = 1 - lost, r = std::sqrt(std::max(0.0, lost * (1 + z))), phi = 2 * kPi * u[1];
        return {position, frame.toWorld({float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)}), conePdf()};
    }
    double directionPdf(const EmissionContext&, const Vertex&, const Vec3f& w) const { return angle(w) < cutoff ? conePdf() : 0; }
    void invertDirection(const EmissionContext&, const Vertex& x0, const Vertex& x1, Block& u) const {
        const Vec3f w = frame.toLocal(directionTo(x0, x1));
        const double s = std::sin(0.5 * std::atan2(std::hypot(w.x, w.y), double(w.z)));
        u[0] = std::min(1.0, 2 * s * s / (1 - std::cos(cutoff)));
        u[1] = inverseAzimuth(w.x, w.y);
    }

    Spectrum radiance(const EmissionContext&, const Vertex&, const Vec3f& w) const {
        const double theta = angle(w);
        if (theta >= cutoff) return Spectrum(0.0);
        return theta <= beam ? intensity : intensity * ((cutoff - theta) / (cutoff - beam));
    }

private:
    double conePdf() const { return 1 / (2 * kPi * (1 - std::cos(cutoff))); }
    double angle(const Vec3f& w) const {
        const Vec3f l = frame.toLocal(w);
        return std::atan2(std::hypot(double(l.x), double(l.y)), double(l.z));
    }
};

}  // namespace ulam
