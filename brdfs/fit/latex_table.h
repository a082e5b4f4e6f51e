#pragma once

#include <brdfs/fit/fit_json.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// A number for LaTeX with its standard error in units of its last digits, two of them:
/// "0.0663(22)" is 0.0663 +- 0.0022, "1.235(68)\times10^{4}" is 12350 +- 680, in math mode. Without
/// an error above 0, six digits; with one below 1e-8 of the number, six digits and \pm.
std::string latexNumber(double value, double error);

/// Text in which none of LaTeX's special characters is one. Control characters become '?'.
std::string latexText(std::string_view text);

/// The parameters of a fit as LaTeX that needs no package: a tabular of those that all channels
/// share, and one with a row for each channel or wavelength, with values, errors and units; below,
/// N, chi-square per degree of freedom with its probability (or the root mean square residual), the
/// model, the data and the weights. \toprule, \midrule and \bottomrule are those of booktabs where
/// it is loaded, and else \hline.
std::string latexTable(const FitReport& report);

}  // namespace hshfit::brdfs
