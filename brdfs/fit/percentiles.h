#pragma once

#include <brdfs/fit/uncertainty.h>

#include <vector>

namespace hshfit::brdfs {

/// The value below which a share of sorted values lies, between the two nearest.
double percentile(const std::vector<double>& sorted, double share);

/// Standard deviation and percentiles of draws, at least two.
ParameterUncertainty::Bootstrap summarised(std::vector<double> draws);

}  // namespace hshfit::brdfs
