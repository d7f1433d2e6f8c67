#pragma once
// Tools that path mutations share: taking over the unchanged ends of a path, growing new vertices from either side, and
// joining them.

#include "core/mcmc/sample.h"

namespace ulam {

/// A new path y that keeps x_0 … x_l and x_m … x_k of x and has `added` edges between them. l = −1 and m = k+1 keep
/// nothing on that side. Vertices are grown inwards from both sides until one edge is missing; join() adds it.
class PathEdit {
public:
    /// y must be uninitialised but for its construction.
    PathEdit(const Sample& x, int l, int m, int added, StepContext& context, Sample& y);

    /// One more vertex on the light's side, sampled as a walk from the light would: from the emitters, or by the BSDF.
    /// `direct`: x_0 by next-event estimation. Returns why there is none.
    Reject growFromLight(const Block& numbers, bool direct = false);
    /// One more vertex on the camera's side.
    Reject growFromCamera(const Block& numbers);
    /// One more vertex on the camera's side, along a given direction.
    Reject growFromCameraAlong(const Vec3f& direction);
    /// One more vertex on the light's side, along a given direction.
    Reject growFromLightAlong(const Vec3f& direction);

    /// One more vertex on the camera's side, made elsewhere.
    void takeFromCamera(const Vertex& v) { y_.path[back_--] = v; }
    /// One more vertex on either side, where the last vertex scatters by a given delta lobe.
    Reject followFromCamera(Lobe lobe);
    Reject followFromLight(Lobe lobe);

    /// All vertices but the connection are there: checks the connecting edge, evaluates the factors of the changed range
    /// and casts the visibility ray, cheapest first. Where the camera's side has grown to x_0, nothing is left to join.
    Reject join();

private:
    StepContext& context_;
    Sample& y_;
    int l_, m_;
    int front_, back_;  ///< next index to fill from the light, from the camera
};

}  // namespace ulam
