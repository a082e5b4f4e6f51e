#pragma once

#include <hshfit/gpu/forms/internal/form_text.h>
#include <hshfit/representation/factoring_blocks.h>

#include <string>
#include <vector>

namespace hshfit::gpu::inline forms {

/// The names of basis functions at wi and wo in templates/basis.mustache. Isotropic forms are
/// turned about z until wo has azimuth 0, where its sines are 0.
struct BasisNames {
    std::vector<int> slots;  ///< of all functions, ascending
    ProductSymmetry symmetry;

    std::string ofWi(int slot) const;
    std::string ofWo(int slot) const;
    /// A product function (basis_matrix.h).
    std::string product(const ProductTerm& term) const;

private:
    std::size_t at(int slot) const;
};

/// A factored form basis: for each block, in the order of the file,
///     left right          y_r = sum of right over wi, then y_r times the sum of left over wo
///     right^T core right  y_r, and z_r over wo likewise, then core times their products
///     whole               the sum over its terms
struct FactoredSums {
    std::vector<StreamNumber> stream;
    SumGroup sums;
};
/// Throws InputError as multipliedOut does.
FactoredSums factoredSums(const Representation& form, const std::vector<ProductTerm>& terms,
                          const BasisNames& names);

}  // namespace hshfit::gpu::inline forms
