#pragma once

#include <hshfit/representation/halfway/internal/halfway_albedo.h>
#include <hshfit/representation/halfway/internal/halfway_bounds.h>

namespace hshfit::inline representation::inline halfway {

/// The fewest nodes that raise the loss of the pairs held out by at most 2 % and take at most 3 %
/// of the albedo away from the expansion; if none do, those that take least.
EnvelopeArray chooseLimit(const HalfwayTerms& terms, const HalfwayBounds& bounds,
                          const HalfwaySamples& left, const HalfwayAlbedo& albedo,
                          const HalfwayValues& values);

/// ln of the envelope at places, [place][channel].
std::vector<double> capsAt(const EnvelopeArray& limit, bool reciprocal,
                           const std::vector<EnvelopePoint>& places);

}  // namespace hshfit::inline representation::inline halfway
