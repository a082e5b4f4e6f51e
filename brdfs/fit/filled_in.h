#pragma once

#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/parametric_sum.h>

#include <vector>

namespace hshfit::brdfs {

/// Sets `spec`, or `spectrum` of channels with wavelengths, of a fit: shapes as
/// ParametricSum::filledIn takes them, linear[k * channels + c].
void fillIn(const ParametricSum& sum, const std::vector<std::vector<double>>& shapes,
            const std::vector<double>& linear, const Channels& channels, FitResult& result);

}  // namespace hshfit::brdfs
