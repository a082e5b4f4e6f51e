#pragma once

#include <brdfs/fit/fit_result.h>
#include <hshfit/pages/print_figure.h>

#include <optional>

namespace hshfit::brdfs {

/// The correlations of the parameters as a map from -1 to 1, scales of scans left out; none of
/// fewer than two parameters. Rows and columns are numbered in the order of the result.
std::optional<PrintFigure> correlationFigure(const FitResult& result);

/// Studentised residuals against leverage, with the bound of outliers, and Cook's distances by the
/// number of the value; of many values the 3000 of the largest distances. None without a study.
std::optional<PrintFigure> influenceFigure(const FitResult& result);

}  // namespace hshfit::brdfs
