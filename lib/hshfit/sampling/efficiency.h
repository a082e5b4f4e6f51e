#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/sampler.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace hshfit::inline sampling {

/// The distance of a sampler from a BRDF at one outgoing direction. The weight of a sample is f
/// cos(theta_i) / pdf, the mean of |f| over channels.
struct Efficiency {
    Direction wo;
    std::size_t samples = 0;
    double mean = 0;           ///< of the weight: the directional albedo, for f >= 0
    double standardError = 0;  ///< of the mean
    double variance = 0;       ///< of the weight over the square of the mean; 0 where the mean is 0
    double largest = 0;        ///< weight over the mean
    double wasted = 0;         ///< share of samples with weight 0
    /// Estimates of the directional albedo in white light, per channel, and their standard errors.
    std::vector<double> albedo, albedoError;
};

/// From `samples` draws of a generator that starts at `seed`; the same on every machine.
Efficiency efficiencyAt(const Brdf& brdf, const Sampler& sampler, const Direction& wo,
                        std::size_t samples, std::uint64_t seed = 1);

/// The numbers behind samples, the same on every machine (brdf/uniform.h).
class UniformNumbers {
public:
    explicit UniformNumbers(std::uint64_t seed) : random_(seed) {}
    Uniforms next();

private:
    std::mt19937_64 random_;
};

}  // namespace hshfit::inline sampling
