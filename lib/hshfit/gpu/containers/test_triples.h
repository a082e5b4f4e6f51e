#pragma once

#include <hshfit/gpu/payload.h>

#include <span>
#include <vector>

namespace hshfit::gpu::inline containers {

/// A pair of directions and the payload's value there, with which a reader of the files can
/// check itself.
struct TestTriple {
    Direction wo, wi;           ///< float32-exact, so that shaders start from the same numbers
    std::vector<double> value;  ///< per channel, the sum before it is clamped
};

/// 72 pairs without values: 64 spread evenly over the two hemispheres by Roberts' R sequence (the
/// additive recurrence in powers of the root of x^5 = x + 1), 8 near the pole or within half a
/// degree of the horizon.
std::vector<TestTriple> testPairs();

/// testPairs() with values. For the map `direction` wo is that direction. Values: Reconstruction of
/// unpack(payload), that is the stored, rounded texels, in double precision with the analytic
/// basis.
std::vector<TestTriple> testTriples(const Payload& payload);

/// Largest |difference| between the triples and the payload, relative to the largest value (or
/// absolute, if all are 0).
double largestDifference(const Payload& payload, std::span<const TestTriple> triples);

}  // namespace hshfit::gpu::inline containers
