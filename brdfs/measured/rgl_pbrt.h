#pragma once

#include <brdfs/measured/rgl.h>

#include <array>

namespace hshfit::brdfs {

/// pbrt-v4 reads the spectra of an RGL file alone, multiplies them by ndf / (4 sigma) whatever the
/// field jacobian says, and refuses azimuths of less than a circle (MeasuredBxDF in its bxdfs.cpp).

/// A spectrum for each of red, green and blue at 400 to 700 nm by 20 nm, linear between and
/// constant beyond, as pbrt interpolates. Not negative; the three sum to 1, so that grey is the
/// same at all wavelengths; under D65 a spectrum r R + g G + b B has the linear Rec. 709 colour
/// (r, g, b) by RgbWeights (brdf/colour.h), within 2e-7. Of the spectra that have these properties,
/// those with the least sum of squared differences of neighbours (docs/figures/rgb_spectra.py).
constexpr std::size_t colourWavelengths = 16;
extern const std::array<std::array<float, 3>, colourWavelengths> colourSpectra;
std::array<double, colourWavelengths> colourNanometres();

/// Tables of RGB as spectra, and the factor ndf / (4 sigma) = 1 written out where there is none.
/// Other tables are left as they are.
void makeFitForPbrt(RglTables& tables, std::vector<std::string>& alterations);

}  // namespace hshfit::brdfs
