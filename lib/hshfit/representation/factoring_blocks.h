#pragma once

#include <hshfit/representation/basis_matrix.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::inline representation {

/// Terms of both directions that form one matrix: rows are functions of wo, columns functions of
/// wi. Terms in different blocks share no pair of functions:
///     isotropic             one for each m, and one for each m of sine terms
///     bilateral, otherwise  cosines and sines, even and odd m
///     otherwise             one
/// Where reciprocal, the matrix is symmetric (sine terms: antisymmetric) with the functions of wi
/// and wo the same, and each pair of entries is one term.
struct TermBlock {
    std::string name;  ///< "0", "1", "1s" for m of cosine and sine terms; "c0", "s1", …; "all"
    bool symmetric = false, antisymmetric = false;
    std::vector<int> rows, columns;  ///< slots of the functions of wo and of wi
    /// Entry of the matrix that a term contributes to, and its factor.
    struct Entry {
        std::size_t term, row, column;
        double scale;
    };
    std::vector<Entry> entries;
};

/// The blocks into which these terms fall, with the entries that each of them contributes to.
std::vector<TermBlock> termBlocks(const std::vector<ProductTerm>& terms,
                                  const ProductSymmetry& symmetry);

/// [channel][term] of a factored matrix; a block that is absent is 0. Throws InputError if shapes
/// do not fit the terms, or for a block that is none of `termBlocks`.
std::vector<double> multipliedOut(const Representation& matrix,
                                  const std::vector<ProductTerm>& terms);

}  // namespace hshfit::inline representation
