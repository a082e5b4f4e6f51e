#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace hshfit::inline sampling {

/// Three independent numbers, uniform in [0, 1).
using Uniforms = std::array<double, 3>;

/// An incident direction and its density per steradian. The density is 0 where there is none: wo is
/// not above the horizon.
struct Sample {
    Direction wi;
    double pdf = 0;
};

/// A density of incident directions over the upper hemisphere for each outgoing direction. The
/// density integrates to 1 over the hemisphere: no sample lies below the horizon. The estimate of
/// the integral of f cos(theta_i) L is the mean of f cos(theta_i) L / pdf.
/// Immutable; may be used from many threads at once.
class Sampler {
public:
    virtual ~Sampler() = default;

    virtual std::string_view name() const = 0;
    /// A direction from the density; `pdf` has the same bits as pdf(wo, wi).
    virtual Sample sample(const Direction& wo, const Uniforms& u) const = 0;
    /// Per steradian. Domain: unit vectors; 0 where wi.z <= 0 or wo.z <= 0 or either is NaN.
    virtual double pdf(const Direction& wo, const Direction& wi) const = 0;
};

/// Densities, one for each lobe of a BRDF.
using SamplerList = std::vector<std::shared_ptr<const Sampler>>;

/// A BRDF that names densities close to its f cos(theta_i), apart from the cosine: its parts, each
/// of which covers a lobe. Lambert's is an empty list.
class HasSamplers {
public:
    struct Known {
        bool all = false;  ///< whether the list covers f; if not, f is tabulated as well
        SamplerList samplers = {};
    };
    virtual Known samplers() const = 0;

protected:
    ~HasSamplers() = default;
};

}  // namespace hshfit::inline sampling
