#pragma once

#include <brdfs/fit/fit_json.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Text in which none of LaTeX's special characters is one. Control characters become '?'.
std::string latexText(std::string_view text);

/// The parameters of a fit as LaTeX that needs no package: a tabular of those that all channels
/// share, with standard and expanded uncertainties, k, degrees of freedom and units, and one with a
/// row for each channel or wavelength; below, the route of the uncertainties, correlations, terms
/// of the instrument, N, chi-square per degree of freedom with its probability (or the root mean
/// square residual), the model, the data and the weights. \toprule, \midrule and \bottomrule
/// come from booktabs where it is loaded, and else are \hline.
std::string latexTable(const FitReport& report);

}  // namespace hshfit::brdfs
