#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace hshfit::inline transfer {

/// Factors on the bands against ringing.
enum class Window { none, hann, lanczos, bending };
std::string_view windowName(Window window);
/// Throws UsageError with the names.
Window parseWindow(std::string_view name);

/// The factor on every band l of n = `order` bands (Sloan 2008, "Stupid Spherical Harmonics
/// Tricks"):
///     hann     (1 + cos(pi l / n)) / 2
///     lanczos  sin(pi l / n) / (pi l / n), the sigma factors
///     bending  1 / (1 + lambda l^2 (l + 1)^2)
/// All are 1 for l = 0, so that what band 0 carries stays. `lambda` is for bending only.
std::vector<double> windowFactors(Window window, int order, double lambda = 0);

/// The same for `order` bands and a window of any width n > 0: 0 for l >= n. Bending has no width
/// and is none here.
std::vector<double> windowOfWidth(Window window, int order, double width);

/// The weakest window that makes a function on the sphere non-negative.
struct LeastNegative {
    Window window = Window::none;
    double width = 0;             ///< of hann and lanczos, in bands
    double lambda = 0;            ///< of bending
    std::vector<double> factors;  ///< by band
    double minimum = 0;           ///< of the windowed function, at least -1e-9 of its mean
    double change = 0;            ///< relative L2 change of the coefficients
};
/// `coefficients`: order^2 of spherical harmonics; several channels, one after the other, take one
/// window. For each of hann, lanczos and bending the widest window is found for which no channel
/// is negative anywhere (Sloan 2017, "Deringing Spherical Harmonics", searches the width of one
/// window), by bisection on the minimum over the sphere; the one that changes the coefficients
/// least is returned, and `none` if nothing is negative. Minima are found on a grid of eight nodes
/// a wavelength and refined. Throws NumericError if a channel's mean is negative, UsageError for
/// coefficients that are no whole number of bands.
LeastNegative leastNegativeWindow(std::span<const double> coefficients, int order,
                                  bool condonShortley = false);

/// The minimum over the sphere of a sum of spherical harmonics, found in the same way.
double minimumOnSphere(std::span<const double> coefficients, int order,
                       bool condonShortley = false);

}  // namespace hshfit::inline transfer
