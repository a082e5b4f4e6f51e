#pragma once

#include <hshfit/representation/halfway/internal/halfway_fit.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The error of the logarithm from which on errors count as themselves, not as squares: on the way
/// from constants, and in the end.
inline constexpr double roughHuber = 1, fineHuber = 0.05;
/// Pairs that the lobe is chosen by.
inline constexpr std::size_t lobePairs = 10000;
/// Lobes that are tried with all terms.
inline constexpr std::size_t mostLobes = 3;

/// e of ln(f + e): a thousandth of the greatest mean albedo.
double halfwayFloor(const HalfwayAlbedo& albedo);

/// As many pairs as the coefficients need: at least 24 for a term.
std::size_t halfwayPairsFor(const HalfwayTerms& terms, bool isotropic);

/// A lobe, and the coefficients of few terms that it was chosen with, of one channel.
struct LobeFound {
    HalfwayLobe lobe;
    HalfwayOrders orders;
    HalfwayValues values;
    double loss;
};

/// The lobe whose form of few terms has the least loss over samples of one channel: of widths from
/// the half width of the peak to 0.9, then, where f is not isotropic, of ratios of the widths to
/// 12, and where it is not bilateral, of turns; then of shelves; then with Smith's masking, or
/// without it where f is not isotropic, if that halves the loss; then, where f is not isotropic, of
/// both widths in small steps. All are numbers of single precision. After it come
/// others, up to `mostLobes` in all, each the best of the lobes that are wider or narrower by a
/// factor of 1.5 than the ones before: few terms may prefer a lobe that all terms do not.
std::vector<LobeFound> chooseLobes(const HalfwaySamples& grey, const HalfwayOrders& orders,
                                   const HalfwaySymmetry& symmetry, double floor);

/// Coefficients of all terms and channels to begin with: the coefficients that the lobe was chosen
/// with, in the brightness of each channel.
HalfwayValues startFrom(const LobeFound& found, const HalfwayModel& model,
                        const HalfwaySamples& samples, const HalfwaySymmetry& symmetry);

}  // namespace hshfit::inline representation::inline halfway
