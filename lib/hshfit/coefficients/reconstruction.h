#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>

#include <memory>
#include <span>

namespace hshfit::inline coefficients {

/// A coefficient set as a BRDF again:
///     q(wi, wo) = sum over l, m of c_{l,m}(wo) B_{l,m}(wi)       (Gautron et al. 2004, Eq. 16)
/// with c interpolated over the outgoing map (bilinear in the parabolic plane, linear along
/// elevations, constant for one direction). `eval` returns f: coefficients of f cos(theta_i) are
/// divided by cos(theta_i), which amplifies their truncation error towards the horizon;
/// `evalQuantity` returns q itself. The sum rings: values may be negative; nothing is clamped.
class Reconstruction : public Brdf {
public:
    /// Throws InputError if the basis is unknown or cannot have that order.
    explicit Reconstruction(Coefficients coefficients);

    std::string name() const override { return coefficients_.source; }
    const Channels& channels() const override { return coefficients_.channels; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;

    /// The projected quantity, f or f cos(theta_i); laid out as for `eval`.
    void evalQuantity(const Direction& wo, DirectionBatch wi, double* out) const;

    const Coefficients& coefficients() const { return coefficients_; }
    const Basis& basis() const { return *basis_; }

private:
    Coefficients coefficients_;
    std::unique_ptr<Basis> basis_;
    Laws laws_;
};

/// out[channel * wi.count + k] = sum over slots of c[channel * slots + slot] B_slot(wi_k), 0 below
/// the horizon; any number of channels.
void synthesise(const Basis& basis, std::span<const double> c, DirectionBatch wi, double* out);

/// f from f cos(theta_i), laid out as for `Brdf::eval`.
void divideByCosine(DirectionBatch wi, std::size_t channels, double* values);

}  // namespace hshfit::inline coefficients
