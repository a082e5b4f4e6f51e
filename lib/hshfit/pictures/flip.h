#pragma once

#include <hshfit/pictures/rgb_picture.h>

#include <vector>

namespace hshfit::inline pictures {

struct FlipOptions {
    /// The observer is 0.7 m from a screen 0.7 m wide with 3840 pixels across.
    double pixelsPerDegree = 67.0206;
};

/// The difference that an observer sees who alternates between two pictures: LDR-FLIP (Andersson,
/// Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild 2020, 10.1145/3406183), [row][column],
/// from 0 to 1:
///     dE = dE_c^(1 - dE_f)
/// dE_c is the HyAB distance of Hunt-adjusted L*a*b* colours behind the eye's contrast sensitivity
/// in YCxCz, to the power 0.7, mapped to [0, 1]; dE_f the difference of edges and points in
/// luminance. Pictures are linear Rec. 709 as they are shown: exposed, and clamped to [0, 1] here.
/// Beyond its border a picture goes on as its last pixel. Throws UsageError for different sizes.
std::vector<float> flip(const RgbPicture& reference, const RgbPicture& test,
                        const FlipOptions& options = {});

/// The exposures, in stops, at which HDR-FLIP (Andersson, Nilsson, Shirley & Akenine-Möller 2021,
/// 10.1111/cgf.14251) looks at a sphere here, by the largest channel of each of its pixels: evenly
/// spaced, at most four. The first shows the surface: half of the lit pixels, those above
/// `unlitShare` of the brightest, have their largest channel at or above `shownAsWhite`. At the
/// last the brightest pixel just reaches `shownAsWhite`. 0 alone for a black sphere.
std::vector<double> flipExposures(std::vector<double> largest);

/// The share of the brightest pixel below which pixels have no light.
inline constexpr double unlitShare = 1.0 / 512;

}  // namespace hshfit::inline pictures
