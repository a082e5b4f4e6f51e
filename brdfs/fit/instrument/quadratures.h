#pragma once

#include <brdfs/fit/instrument/fitted_instrument.h>
#include <brdfs/fit/instrument/patch_sums.h>
#include <brdfs/fit/instrument/veil.h>
#include <hshfit/error.h>

#include <optional>
#include <vector>

namespace hshfit::brdfs {

/// The quadratures over apertures, and of stray light over the hemisphere, for a material.
struct Quadratures {
    std::vector<PatchLevels> levels;  ///< one for each sample
    std::optional<Veil> veil = {};
    double averageChange = 0, strayChange = 0;  ///< FittedInstrument

    /// Whether they keep the tolerance for this material; else they do afterwards. Throws
    /// NumericError where no quadrature does.
    bool refine(const Brdf& material, const FitSamples& samples, const Instrument& instrument);
    /// States the quadratures over `averaged` samples.
    void describe(const FitSamples& averaged, FittedInstrument& result) const;
};

/// The error of a fit whose material needed finer quadratures after each of `searches`.
NumericError unsettled(int searches);

/// Samples without the offset and the dark signal that are stated.
FitSamples withoutStated(const FitSamples& samples, const Instrument& instrument);

/// Readings of a material by an instrument of which nothing is fitted, without stray light, scales
/// and zeros: [channel * samples + k].
std::vector<double> statedReadings(const Brdf& material, const FitSamples& samples,
                                   const Instrument& instrument);

}  // namespace hshfit::brdfs
