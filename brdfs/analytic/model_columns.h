#pragma once

#include <brdfs/rows/model.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Pairs of directions, all above the horizon.
struct PairBatch {
    DirectionBatch wi;
    const Direction* wo;  ///< [wi.count]
};

/// The columns that a fit requests of a model: the functions whose sum is f in one channel,
///     f = column_0 + sum_k linear_k column_k,
/// with derivatives by the parameters in which f is not linear.
struct ColumnRequest {
    const Parameters& values;  ///< colours grey or by channel; values of `linears` do not count
    std::span<const std::string> linears = {};  ///< parameters in which f is jointly linear
    /// Parameters of the derivatives; the keys of a group share one value. Empty: no derivatives.
    std::span<const std::vector<std::string>> shapes = {};
    std::size_t channel = 0;  ///< of a model with functions of each channel (Model::channelwise)
};

/// The columns at the values of a request. Thread-safe.
class ModelColumns {
public:
    virtual ~ModelColumns() = default;
    /// Adds column 0 to `base` and writes the linear ones, linear[i * count + k], and the
    /// derivatives by shape j, slopes[(j * (1 + linears) + column) * count + k].
    virtual void fill(const PairBatch& pairs, double* base, double* linear,
                      double* slopes) const = 0;
};

}  // namespace hshfit::brdfs
