#pragma once

#include <hshfit/brdf/channels.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The share with which wavelengths about the nominal one enter a reading, of area 1:
///     box       constant over its width
///     triangle  falls to 0 at one width from the middle, as in a monochromator with equal slits
///     gauss     exp(-4 ln 2 (d / width)^2), cut at 3 widths
struct Slit {
    enum class Shape { none, box, triangle, gauss };
    Shape shape = Shape::none;
    double width = 0;  ///< full width at half maximum, nm
    std::string text;  ///< as it was stated

    bool finite() const { return shape != Shape::none; }
};

/// "SHAPE:WIDTH", nm; empty: none. Throws UsageError.
Slit parseSlit(std::string_view text);

/// Readings as sums over values of f at the wavelengths of the channels, between which f runs
/// straight and beyond which it stays: [reading * channels + channel], rows of sum 1. The identity
/// without a slit.
/// Throws UsageError for channels without wavelengths and for a single one, NumericError for a slit
/// so wide that readings do not determine f (a singular value below 0.1).
std::vector<double> slitMatrix(const Slit& slit, const Channels& channels);

}  // namespace hshfit::brdfs
