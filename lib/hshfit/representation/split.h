#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/representation/representation.h>

#include <memory>
#include <string>

namespace hshfit::inline representation {

/// f - added: lobes and kinks of both, covered where both are; isotropy, mirror symmetry and
/// reciprocity where both have them, energy conservation where f has it and `added` is nowhere
/// negative. Named after f, so that messages and files name what the user gave.
class Remainder final : public Brdf, public HasKinkCurves {
public:
    /// `whole` has to outlive this; `added` may be null. Throws UsageError unless it is grey or has
    /// the channels of `whole`. `nonNegative`: the difference is known to be nowhere negative.
    Remainder(const Brdf& whole, std::unique_ptr<Brdf> added, bool nonNegative);

    std::string name() const override { return whole_.name(); }
    const Channels& channels() const override { return whole_.channels(); }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    std::vector<double> kinks(const Direction& wo) const override;
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override;
    double defaultTolerance() const override;
    void checkIntact() const override;

    const Brdf* added() const { return added_.get(); }

private:
    const Brdf& whole_;
    std::unique_ptr<Brdf> added_;
    Laws laws_;
};

/// The part that was taken out of this BRDF; null if it is no `Remainder`, or nothing was.
const Brdf* addedTo(const Brdf& brdf);

/// A BRDF in two parts: f = added + remainder.
struct Split {
    std::string added;  ///< a specification that the opener takes; empty: nothing to take out
    std::unique_ptr<Brdf> remainder;  ///< refers to the BRDF that was split
};

/// The albedo of the largest Lambert term that leaves a remainder which is nowhere negative:
///     kd = pi * infimum of f over all pairs of directions above the horizon,
/// per channel (spectral: one for all wavelengths, as specifications of Lambert's BRDF have one or
/// three), in [0, 1] and in single precision, rounded down. The infimum is searched on
/// equispaced polar angles to 1 degree above the horizon and azimuths, then from each of the
/// 16 smallest nodes by shrinking steps; f below the search's resolution is not seen.
std::vector<double> diffuseAlbedo(const Brdf& brdf);

/// `what`: "diffuse", the Lambert term above, or a BRDF specification to take out.
/// Throws UsageError as `open` and `Remainder` do.
Split takeOut(const Brdf& brdf, const std::string& what, const BrdfOpener& open);

}  // namespace hshfit::inline representation
