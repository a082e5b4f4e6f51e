#pragma once

#include <hshfit/bases/basis.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline transfer {

/// The tensor of triple products of an orthonormal basis, in its own inner product:
///     T_ijk = integral of B_i B_j B_k d omega        (times cos(theta) for makhotkin-flux),
/// with which the product of a = sum a_i B_i and b = sum b_j B_j has c_k = sum T_ijk a_i b_j.
///
/// T is symmetric in its indices: one entry is stored for i <= j <= k, and none where the
/// selection rules make it 0: for every basis one |m| is the sum of the other two and an even
/// number of the m is negative; for the harmonics of the sphere also l1 + l2 + l3 is even and no l
/// exceeds the sum of the others. Harmonics of the sphere (Gaunt coefficients) by 3j symbols, the
/// others by quadrature that is exact for them. Absolute error below 1e-13 to order 30. The
/// Condon-Shortley phase does not change T.
class TripleProducts {
public:
    /// Throws UsageError for a basis that is not orthonormal and for more than `mostEntries`.
    explicit TripleProducts(const Basis& basis, std::size_t mostEntries = 100'000'000);
    /// The number of entries that the basis needs, by counting; ends once it is above `most`.
    static std::size_t count(const Basis& basis, std::size_t most = ~std::size_t{0});

    struct Entry {
        std::uint32_t i, j, k;  ///< slots, ascending
        double value;
    };
    std::span<const Entry> entries() const { return entries_; }
    /// In any order of the slots; 0 for an entry that is not stored.
    double at(std::size_t i, std::size_t j, std::size_t k) const;

    /// out[k] = sum T_ijk a_i b_j: the first order^2 coefficients of the product of two vectors of
    /// order^2. Bands above are cut off; `multiplied` (products.h) says how much they carry.
    void multiply(std::span<const double> a, std::span<const double> b, double* out) const;

private:
    void sort();
    int order_;
    std::vector<Entry> entries_;
};

}  // namespace hshfit::inline transfer
