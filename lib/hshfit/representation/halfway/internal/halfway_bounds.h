#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/halfway/halfway_envelope.h>
#include <hshfit/representation/stored_array.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The form is nowhere above this many times the greatest f at the same elevations.
constexpr double boundFactor = 1.5;

/// The greatest f over azimuths at pairs of elevations all over the axes of the envelope.
struct HalfwayBounds {
    std::vector<EnvelopePoint> points;
    std::vector<double> logs;  ///< ln f, [point][channel]
    std::size_t channels = 0;
    bool reciprocal = true;
};

/// `reciprocal`: the greater of the two orders of a pair. Azimuths are 48 of wi about wo, close to
/// each other at the mirror direction, or 24 for each of 6 of wo where f depends on it. Below
/// `floor`, f counts as that: a bound of 0 has no logarithm. Throws NumericError where f is not
/// finite.
HalfwayBounds boundsOf(const Brdf& brdf, bool reciprocal, double floor);

/// The envelope with `alongA` (an odd number, or 1, where not reciprocal) times `alongB` nodes, in
/// unorm8. At every point it is below boundFactor times f, and as little below f as the grid lets
/// it, where f is bright rather than where it is dark.
StoredArray fitEnvelope(const HalfwayBounds& bounds, std::size_t alongA, std::size_t alongB,
                        double ridge);

}  // namespace hshfit::inline representation::inline halfway
