#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/free_parameters.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The columns of one term of a sum, with derivatives by automatic differentiation (Ceres' Jets):
/// a second, templated writing of the lobes that are fitted most, which tests hold to Brdf::eval.
/// Several times faster than differences of the catalog's models.
class LobeFormula {
public:
    virtual ~LobeFormula() = default;
    /// For samples [begin, begin + size): adds column 0 to `base` and writes the linear ones,
    /// linear[i * size + k], at the given values of the term's shapes. With `slopes`, also the
    /// derivatives by the value of shape j: slopes[(j * (1 + linear count) + column) * size + k].
    virtual void fill(const FitSamples& samples, std::size_t begin, std::size_t size,
                      std::span<const double> shapes, double* base, double* linear,
                      double* slopes) const = 0;
};

/// Null for a model, or choices or stated numbers of it, that has none. There are formulas of
/// lambert, blinn-phong (not normalised), ward, ggx and beckmann (Schlick), cook-torrance (F0), abc
/// and sgd, isotropic.
std::unique_ptr<LobeFormula> makeLobeFormula(const Model& model, const Parameters& stated,
                                             const std::vector<FreeParameter>& shapes,
                                             const std::vector<std::string>& linearKeys);

}  // namespace hshfit::brdfs
