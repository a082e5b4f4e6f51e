#pragma once

#include <brdfs/fit/fit_samples.h>

#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// A light under which fits of `picture` look at spheres: its specification (light/catalog.h), of
/// the same radiance in all channels. +z is up; the viewer is at theta 75, phi 0 degrees.
struct PictureLightRow {
    std::string_view name, spec;
};
std::span<const PictureLightRow> pictureLights();

struct PictureSampleOptions {
    int rings = 12, around = 12;  ///< pixels of lights with an extent
    int points = 512;             ///< pixels of parallel light, each of two kinds
    int order = 12;               ///< of gridFor, which integrates over lights with an extent
    int level = 0;                ///< of gridFor
    double grazingCut = 90;       ///< degrees: beyond it there are neither pixels nor light
    bool fewer = true;            ///< add a ninth of the pixels, on a coarser grid, for starts
};

/// The radiance of a sphere of the material in the pixels of an orthographic picture, under each of
/// pictureLights(): samples of origin `pixels`,
///     value = exposure times the integral of L(wi) f(wi, wo) cos(theta_i), white is 1,
/// with the exposure of each light at which 95 % of its pixels have their largest channel at or
/// below `shownAsWhite` of white (rgb_picture.h) and the brightest is at most twelve stops above
/// that. Weights are the areas of the pixels, scaled to the same sum for each light. The pixel that
/// mirrors parallel light weighs a fiftieth of its sphere.
/// Lights with an extent are integrated by gridFor with the lobes of f, at pixels on rings of equal
/// area; under parallel light half of the pixels are spread evenly, the others about the highlight,
/// with weights by the balance heuristic, so that lobes of any width are seen.
/// f is evaluated wherever a pixel needs it. Throws NumericError if it is not finite, or 0.
FitSamples pictureSamples(const Brdf& data, const PictureSampleOptions& options = {});

}  // namespace hshfit::brdfs
