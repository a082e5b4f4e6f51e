#pragma once

#include <string>

namespace hshfit::brdfs {

/// A number with its standard error in units of its last digits, two of them, for LaTeX in math
/// mode: "0.0663(22)" is 0.0663 +- 0.0022, "1.235(68)\times10^{4}" is 12350 +- 680. Without an
/// error above 0, six digits; with one below 1e-8 of the number, six digits and \pm.
std::string latexNumber(double value, double error);
/// A number of so many digits, likewise.
std::string latexValue(double value, int digits = 6);

/// Both as text: "1.235(68)×10⁴".
std::string plainNumber(double value, double error);
std::string plainValue(double value, int digits = 6);

/// An uncertainty with both of its two digits, "0.0020".
std::string latexError(double error);
std::string plainError(double error);

}  // namespace hshfit::brdfs
