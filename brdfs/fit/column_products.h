#pragma once

#include <cstddef>

namespace hshfit::brdfs {

/// Columns of one length, a stride apart.
struct ColumnSpan {
    const double* first = nullptr;
    std::size_t columns = 0, stride = 0;
};

/// out[i + j * outStride] += sum_{k < length} a_i[k] b_j[k], by the widest vectors of the machine.
/// Sums have a fixed order on one machine.
void addProducts(const ColumnSpan& a, const ColumnSpan& b, std::size_t length, double* out,
                 std::size_t outStride);

/// Adds the products of a with itself; some of the parts above the diagonal are left as they are.
void addGram(const ColumnSpan& a, std::size_t length, double* out, std::size_t outStride);

}  // namespace hshfit::brdfs
