#pragma once

#include <hshfit/representation/stored_array.h>

#include <string>
#include <variant>
#include <vector>

namespace hshfit::inline representation {

/// Kind outgoing: c_i(wo) as they are.
struct CoefficientArray {
    StoredArray coefficients;  ///< [outgoing][channel][slot]
};
/// Kind outgoing: c_i(wo) = left times right.
struct CoefficientFactors {
    StoredArray left;   ///< [outgoing * channels + channel][rank]
    StoredArray right;  ///< [rank][slot]
};
/// Kind basis: c_t as they are.
struct MatrixArray {
    StoredArray matrix;  ///< [channel][term]
};
/// One block of a matrix (factoring_blocks.h) that is no smaller as factors.
struct WholeBlock {
    StoredArray terms;  ///< [channel][term of the block]
};
/// A block as left times right.
struct ProductBlock {
    StoredArray left;   ///< [channel * rows + row][rank]
    StoredArray right;  ///< [rank][column]
};
/// A symmetric block as right^T core right.
struct SymmetricBlock {
    StoredArray core;   ///< [channel][lower triangle of rank x rank]
    StoredArray right;  ///< [rank][column]
};
struct MatrixBlock {
    std::string name;  ///< TermBlock::name
    std::variant<WholeBlock, ProductBlock, SymmetricBlock> part;
};
/// Kind basis: c_t by blocks; blocks that are left out are 0.
struct MatrixFactors {
    std::vector<MatrixBlock> blocks;
};
/// The GGX lobe that the halfway form is built about: its roughness along an axis of the surface
/// that is turned from x by `turn` radians, and across it, and what bounds it at the horizon.
/// `masked`: by Smith's masking of its facets, which depends on the azimuth where the lobe is not
/// round. See halfway_axes.h.
struct HalfwayLobe {
    double along = 0.5, across = 0.5, turn = 0, shelf = 0.05;
    bool masked = false;
};
/// The bounds of one channel of the halfway form: of the exponents of both parts, and of f.
struct HalfwayCeiling {
    double smooth = 0, lobe = 0, top = 0;
};
/// Kind halfway: the two exponents of halfway.h.
struct HalfwayArray {
    StoredArray halfway;                        ///< [channel][term]
    HalfwayLobe lobe = {};                      ///< equal widths and no turn where f is isotropic
    std::vector<HalfwayCeiling> ceilings = {};  ///< [channel]
};

/// The numbers of a representation.
using Content =
    std::variant<CoefficientArray, CoefficientFactors, MatrixArray, MatrixFactors, HalfwayArray>;

}  // namespace hshfit::inline representation
