#pragma once

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/tradeoff/sweep.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::tradeoff {

/// The best terms of spherical wavelets (hshfit/wavelets/slices.h), an adaptive form to compare
/// with. No file holds it, so that it takes no part in fronts.
struct MeasuredWavelets {
    std::string outgoing;
    std::size_t terms = 0;  ///< of each outgoing direction and channel
    /// Bytes of a value, 4 or 2; an index of 2 comes on top.
    std::size_t valueBytes = 0;
    std::size_t bytes = 0;  ///< values and indices
    PairErrors errors;
    std::vector<PairErrors> bands;  ///< by elevation of wo, see bandEdges

    /// "soho, best 36 terms, half, outgoing 16"
    std::string name() const;
};

/// For every outgoing set of the sweep that the forms per outgoing direction have, as many terms as
/// each of its orders has slots, in single and half precision; terms that take more than `maxBytes`
/// are left out. Empty where f is not finite at the centre of a leaf.
std::vector<MeasuredWavelets> measureWavelets(const Brdf& brdf, const PairReference& reference,
                                              const Sweep& sweep, std::size_t maxBytes);

}  // namespace hshfit::tradeoff
