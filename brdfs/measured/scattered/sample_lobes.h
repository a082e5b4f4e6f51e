#pragma once

#include <brdfs/measured/scattered/samples.h>

namespace hshfit::brdfs {

/// Widths of the lobes that scattered samples show, for Lobe::width; 0: no such lobe.
struct SampleLobes {
    double mirror = 0;  ///< by the slope of the half vector
    double back = 0;    ///< by the angle between wi and wo, radians
};

/// A lobe is where the mean of the samples near its centre is above four times their median. Its
/// width is that within which the mean stays above half of its largest, in bins that double from
/// 0.5 degrees on. For samples of pairs of directions.
SampleLobes sampleLobes(const Samples& samples);

}  // namespace hshfit::brdfs
