#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/pictures/lab.h>
#include <hshfit/pictures/sphere.h>

namespace hshfit::material_library {

/// The looks of a material in a picture and a few numbers.
struct MaterialLook {
    LinearRgb albedo{};    ///< the light of a uniform dome that is reflected, as a share
    double luminance = 0;  ///< of the albedo, Rec. 709
    /// Chroma and hue of the albedo in CIE L*a*b*. Chroma is 0 for grey. Hue is in degrees from 0
    /// to 360, from a towards b, and 0 for grey.
    double chroma = 0, hue = 0;
    /// The share of the light reflected at 45 degrees that goes to within 10 degrees of the mirror
    /// direction, luminance; 0.021 for Lambert, near 1 for a mirror.
    double gloss = 0;
    SpherePicture picture = {};  ///< under the lights of SphereRig
};

/// The look of a grey or RGB material; values of f below 0 count as 0. The digits do not depend on
/// the number of threads.
MaterialLook lookOf(const Brdf& brdf, int pixels);

}  // namespace hshfit::material_library
