#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/instrument/instrument.h>

#include <span>
#include <vector>

namespace hshfit::brdfs {

/// Step of central differences by an angle, radians: rounding, 1e-16 / step, and the third
/// derivative, step^2, of lobes 0.001 wide are below 1e-4.
constexpr double angleStep = 1e-5;

/// Errors of the zeros of a goniometer's angles, radians, both in the plane of incidence (the xz
/// plane at normal incidence): the light comes from `incidence` further from the normal than a
/// sample states; the detector is `detector` further from the normal on the side of the mirror
/// direction, and nearer to it on the side of the light.
struct AngleZeros {
    double incidence = 0, detector = 0;
};

/// Samples at the directions where they were taken: turned by one pair of zeros, or by one for each
/// sample. Averages over apertures (FitSamples::sums) turn as a whole; what would turn below the
/// horizon stays on it.
FitSamples turned(const FitSamples& samples, std::span<const AngleZeros> zeros);

/// The cosines of turned samples over the cosines that their readings were divided by: a factor of
/// f.
std::vector<double> cosineRatios(const FitSamples& turned, const FitSamples& stated,
                                 Cosines cosines);

}  // namespace hshfit::brdfs
