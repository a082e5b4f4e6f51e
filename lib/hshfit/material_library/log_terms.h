#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/halfway/halfway_axes.h>
#include <hshfit/representation/halfway/halfway_terms.h>

#include <cstddef>
#include <vector>

namespace hshfit::material_library {

/// f + logOffset is the number whose logarithm a library keeps, 1/sr.
inline constexpr double logOffset = 1e-3;

/// The functions over which a library expands ln(f + logOffset): products of Legendre polynomials
/// along the axes of the halfway form (halfway_axes.h), smooth and about the half vector, as
/// HalfwayTerms lists them for orders 16,8,7 and an isotropic, mirror symmetric and reciprocal f;
/// the smooth ones of v alone are left out, since the others have them too. All materials share one
/// roughness of the axis x, 0.02: their sums are linear.
class LogTerms {
public:
    LogTerms();
    std::size_t size() const { return kept_.size(); }
    /// out[term] for two directions above the horizon.
    void evaluate(const Direction& wi, const Direction& wo, double* out) const;

    /// The functions that these are some of, the places of these among them, and the axes' lobe.
    const HalfwayTerms& all() const { return terms_; }
    const std::vector<std::size_t>& kept() const { return kept_; }
    static HalfwayLobe lobe();

private:
    HalfwayTerms terms_;
    HalfwayAxes axes_;
    std::vector<std::size_t> kept_;  ///< into the list of HalfwayTerms
};

/// The only member, made on the first call, from any thread.
const LogTerms& logTerms();

}  // namespace hshfit::material_library
