#pragma once

#include <hshfit/sampling/sampler.h>

namespace hshfit::inline sampling {

/// A density over the whole sphere, folded at the horizon: a direction below it is mirrored up, and
///     pdf(wi) = p(wi) + p(wi mirrored at the horizon).
/// Compared with wasted samples, the second moment of f cos / pdf never grows, since pdf is at
/// least p everywhere.
class FoldedSampler : public Sampler {
public:
    Sample sample(const Direction& wo, const Uniforms& u) const final;
    double pdf(const Direction& wo, const Direction& wi) const final;

protected:
    /// A unit direction of the sphere for wo above the horizon.
    virtual Direction draw(const Direction& wo, const Uniforms& u) const = 0;
    virtual double density(const Direction& wo, const Direction& wi) const = 0;
};

/// A direction of any length, as a unit vector mirrored up if it is below the horizon.
Direction foldedUp(const Direction& wi);

/// Whether both are above the horizon; false for NaN.
inline bool aboveHorizon(const Direction& wo, const Direction& wi) {
    return wo.z > 0 && wi.z > 0;
}

}  // namespace hshfit::inline sampling
