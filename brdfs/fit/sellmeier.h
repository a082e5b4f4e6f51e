#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// Sellmeier's formula over a band, n^2 = 1 + sum_i B_i lambda^2 / (lambda^2 - C_i), lambda in
/// micrometres (Sellmeier 1871, 10.1002/andp.18712190612), in coefficients of which any in a box
/// keeps n^2 > 1 and poles out of the band:
///     terms 1 and 2   s = B l^2 / (l^2 - C) at the lower end l of the band; sqrt(C), below 0.9 l
///     term 3          q, its share of the others' n^2 - 1 at the upper end u, which it lowers;
///                     sqrt(C), above 1.1 u
/// The box ends where n would exceed `most`.
void sellmeierBox(double first, double last, double most, std::size_t terms,
                  std::vector<double>& lower, std::vector<double>& upper);

/// n at a wavelength in nm of the band from `first` to `last`, and its derivatives by the
/// coefficients.
double sellmeierIndex(double nanometres, double first, double last,
                      std::span<const double> coefficients, double* slopes);

/// B1, C1, B2, … and their derivatives [i * n + j] by coefficient j; C in square micrometres.
void sellmeierTerms(double first, double last, std::span<const double> coefficients,
                    std::vector<double>& values, std::vector<double>& slopes);

}  // namespace hshfit::brdfs
