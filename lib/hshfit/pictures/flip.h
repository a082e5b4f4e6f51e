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

}  // namespace hshfit::inline pictures
