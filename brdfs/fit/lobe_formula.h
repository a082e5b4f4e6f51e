#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/free_parameters.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The columns of one term of a sum for one set of its shapes. Thread-safe.
class LobeColumns {
public:
    virtual ~LobeColumns() = default;
    /// For samples [begin, begin + size): adds column 0 to `base` and writes the linear ones,
    /// linear[i * size + k]; if made with derivatives, also those by the value of shape j:
    /// slopes[(j * (1 + linear count) + column) * size + k].
    virtual void fill(const FitSamples& samples, std::size_t begin, std::size_t size, double* base,
                      double* linear, double* slopes) const = 0;
};

/// Columns with derivatives by automatic differentiation (Ceres' Jets): a second, templated writing
/// of the lobes of the catalog, which tests hold to Brdf::eval. Several times faster than
/// differences of the catalog's models.
class LobeFormula {
public:
    virtual ~LobeFormula() = default;
    /// `shapes`: values of the free shapes. The result refers to the formula.
    virtual std::unique_ptr<LobeColumns> at(std::span<const double> shapes,
                                            bool derivatives) const = 0;
};

/// Null for a model, or choices or stated numbers of it, that has none (lobes_*.cpp have the
/// tables; he and the rough diffuse models have none, most are isotropic).
std::unique_ptr<LobeFormula> makeLobeFormula(const Model& model, const Parameters& stated,
                                             const std::vector<FreeParameter>& shapes,
                                             const std::vector<std::string>& linearKeys);

}  // namespace hshfit::brdfs
