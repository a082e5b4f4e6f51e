#pragma once

#include <brdfs/catalog.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Pairs of directions, all above the horizon.
struct PairBatch {
    DirectionBatch wi;
    const Direction* wo;  ///< [wi.count]
};

/// The columns that a fit asks of a model: the functions of which f is a sum in one channel,
///     f = column_0 + sum_k linear_k column_k,
/// with derivatives by parameters that f is not linear in.
struct ColumnRequest {
    const Parameters& values;                   ///< colours grey; those of `linears` do not count
    std::span<const std::string> linears = {};  ///< parameters that f is linear in, jointly
    /// Parameters that derivatives are taken by; the keys of a group have one value. Empty: none.
    std::span<const std::vector<std::string>> shapes = {};
};

/// These columns at the values of the request. Thread-safe.
class ModelColumns {
public:
    virtual ~ModelColumns() = default;
    /// Adds column 0 to `base` and writes the linear ones, linear[i * count + k], and the
    /// derivatives by shape j, slopes[(j * (1 + linears) + column) * count + k].
    virtual void fill(const PairBatch& pairs, double* base, double* linear,
                      double* slopes) const = 0;
};

}  // namespace hshfit::brdfs
