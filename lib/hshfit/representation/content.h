#pragma once

#include <hshfit/representation/stored_array.h>

#include <optional>
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
/// Kind basis: c_t by blocks; those that are left out are 0.
struct MatrixFactors {
    std::vector<MatrixBlock> blocks;
};
/// The greatest f of the halfway form by elevations: see halfway_envelope.h.
struct EnvelopeArray {
    StoredArray logs;  ///< [node along b][node along x][channel]
    double ridge = 1;  ///< the width of its ridge
};
/// Kind halfway: the expansion of ln(1 + f).
struct HalfwayArray {
    StoredArray halfway;                         ///< [channel][term]
    std::optional<EnvelopeArray> envelope = {};  ///< none in files from before there was one
};

/// The numbers of a representation.
using Content =
    std::variant<CoefficientArray, CoefficientFactors, MatrixArray, MatrixFactors, HalfwayArray>;

}  // namespace hshfit::inline representation
