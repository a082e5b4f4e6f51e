#pragma once

#include <hshfit/brdf/brdf.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline brdf {

/// Linear Rec. 709 RGB of a reflecting surface from its values at some wavelengths, under D65:
///     X = k sum of S(lambda) f(lambda) xbar(lambda), Y and Z likewise, k = 1 / sum of S ybar,
/// over 380 to 780 nm by 5 nm with the CIE 1931 2-degree colour-matching functions and illuminant
/// D65 (CIE 15:2004, tables T.1 and T.4), then the matrix of the Rec. 709 primaries for that white:
/// a surface with f the same at all wavelengths has R = G = B = f.
/// Between wavelengths f is taken as linear, beyond the first and the last as constant. Saturated
/// colours are outside of the gamut and have negative components; these are kept.
struct RgbWeights {
    /// One weight per wavelength: R = sum of weights[0][i] f(lambda_i), then G, B.
    std::array<std::vector<double>, 3> weights;
    /// The share of luminance at wavelengths beyond the first and the last.
    double continued = 0;
};

/// Throws UsageError for fewer than three wavelengths, or if more than a twentieth of the luminance
/// lies beyond them. `nanometres`: ascending.
RgbWeights rgbWeights(std::span<const double> nanometres);

/// CIE XYZ (Y = 1 for f = 1) of f given at the wavelengths, with the rules above but for the
/// limits.
std::array<double, 3> tristimulus(std::span<const double> nanometres, std::span<const double> f);

/// CIE XYZ of radiance per nanometre at the given wavelengths, the sum of L xbar over 380 to 780 nm
/// by 5 nm times 5 nm (Y likewise, so that 683 lm/W times Y is the luminance); linear between
/// wavelengths, constant beyond.
std::array<double, 3> tristimulusOfRadiance(std::span<const double> nanometres,
                                            std::span<const double> radiance);

/// Linear Rec. 709 of CIE XYZ, with R = G = B = 1 for Y = 1 at the chromaticity of D65, (0.3127,
/// 0.3290). Components of colours beyond the gamut are negative.
std::array<double, 3> rec709FromXyz(const std::array<double, 3>& xyz);

/// A spectral BRDF seen as RGB: `rgbWeights` applied to every value. Its name is "rgb:" and the
/// name of the spectral BRDF.
/// Throws UsageError if the BRDF is not spectral, and as rgbWeights does.
std::unique_ptr<Brdf> asRgb(std::unique_ptr<Brdf> spectral);

}  // namespace hshfit::inline brdf
