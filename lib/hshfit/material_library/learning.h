#pragma once

#include <hshfit/material_library/basis.h>

#include <cstddef>
#include <vector>

namespace hshfit::material_library {

class MaterialStore;

struct LearnOptions {
    std::size_t components = 0;  ///< at most; 0: by the error of materials that take no part
    std::size_t bytes = 120;     ///< of a material of three channels; of one channel a third
    double heldOut = 0.2;        ///< share of the materials that take no part in that choice

    bool operator==(const LearnOptions&) const = default;
};

/// A basis of so many components, and the root mean square error of ln(f + logOffset) of the
/// materials that took no part, as they are stored; their mean.
struct ComponentsTrial {
    std::size_t components = 0;
    double error = 0;
};

struct LearnedBasis {
    Basis basis;
    std::vector<ComponentsTrial> trials = {};  ///< by rising components; empty: none could be made
    double unseen = 0;      ///< the error of a trial of the components that were taken; 0: none
    double unseenFlip = 0;  ///< the mean FLIP of at most 64 of these, where pictures are asked for
    std::size_t doubted = 0;  ///< materials that counted for less than half in the components
};

/// Mean and principal components of the channels of all materials, each a vector of its own, in the
/// metric of `space` and of equal weight. A material's distance is from the first components of
/// nine tenths of the materials, without its own tenth (cross-validation); one thrice as far as the
/// median counts for less, by the square of its distance. The widths are those by which `bytes`
/// hold all coordinates in the smallest steps. `components` that
/// are not stated: of a ladder the fewest whose trial is within 3 % of the least.
/// With `pictures`, FLIP of the materials that took no part is measured too.
/// The result depends on the order of the materials, which have to be sorted, and on no number of
/// threads. Memory holds 50 bytes a material and a block of them; vectors are on a disk, beside the
/// store. Throws UsageError for fewer than two vectors, and for bytes that do not hold one
/// component, and OutputError as the store does.
LearnedBasis learnBasis(const LogSpace& space, const MaterialStore& materials,
                        const LearnOptions& options, bool pictures = false);

}  // namespace hshfit::material_library
