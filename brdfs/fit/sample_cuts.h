#pragma once

#include <brdfs/fit/fit_samples.h>
#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Samples of one fixed direction whose other direction lies in its plane of incidence.
struct SampleCut {
    double theta = 0, azimuth = 0;     ///< of the fixed direction, degrees; means over its samples
    std::vector<std::size_t> samples;  ///< indices, by angle
    /// Degrees of the other direction from the normal, above 0 on the side of the mirror direction;
    /// of retroreflection the angle of both.
    std::vector<double> angles;
};

/// Measured samples by planes of incidence, as goniometers scan them.
struct SampleCuts {
    enum class Of {
        incidence,  ///< wi fixed, wo scans
        outgoing,   ///< wo fixed, wi scans
        retro       ///< both are one
    };
    Of of = Of::incidence;
    std::vector<SampleCut> cuts;  ///< by theta, then azimuth
    std::size_t inPlane = 0;      ///< samples in a cut

    /// The pair of directions at an angle of a cut.
    DirectionPair pairAt(const SampleCut& cut, double angle) const;
};

/// The cuts with three samples or more. Directions count as one within 0.5 degrees of elevation and
/// 1 degree of azimuth (isotropic data: of any azimuth), and as in the plane within 1 degree. The
/// fixed direction is the one whose cuts hold more samples; without cuts of either,
/// retroreflection.
SampleCuts cutsOf(const FitSamples& samples);

/// The cuts to draw: "auto", at most six from the first to the last elevation; "all"; or elevations
/// in degrees with commas, each within 1 degree of a measured one. Throws UsageError.
SampleCuts chosenCuts(SampleCuts cuts, const std::string& panels);
/// Throws UsageError unless `panels` is one of these, whatever was measured.
void checkPanels(const std::string& panels);

}  // namespace hshfit::brdfs
