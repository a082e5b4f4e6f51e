#pragma once

#include <brdfs/fit/dispersion_law.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A sum of models whose parameters follow laws over the wavelength. `coefficients` belong to
/// all laws, one after the other: of the shapes, then of the linear parameters. Laws of an index of
/// refraction give its value, laws of other shapes u (ShapeParameter).
class DispersedModel {
public:
    /// Shapes without a law are shared, linear parameters are free. Throws UsageError for the model
    /// and for laws that its parameters do not take.
    DispersedModel(std::string_view model, bool isotropic, std::vector<double> nanometres,
                   const std::vector<LawStatement>& laws);

    const std::string& spec() const { return spec_; }
    const std::vector<double>& wavelengths() const { return nanometres_; }
    /// At wavelength c of the data.
    const ParametricSum& sum(std::size_t c) const { return sums_[c]; }
    std::size_t parameterCount() const { return curves_.size(); }
    const LawStatement& law(std::size_t i) const { return laws_[i]; }
    const LawCurve& curve(std::size_t i) const { return curves_[i]; }
    /// Whether the law of parameter i gives an index of refraction and not u (ShapeParameter).
    bool ofIndex(std::size_t i) const;
    /// The first coefficient of parameter i.
    std::size_t first(std::size_t i) const { return first_[i]; }
    std::size_t count() const { return lower_.size(); }
    const std::vector<double>& lower() const { return lower_; }
    const std::vector<double>& upper() const { return upper_; }

    /// x of FitProblem::joint at a wavelength of the data, with its derivatives by the coefficients
    /// [x, coefficient] unless null.
    std::vector<double> pointAt(std::size_t c, std::span<const double> coefficients,
                                Eigen::MatrixXd* slopes) const;
    /// Coefficients whose curves come nearest to points at all wavelengths.
    std::vector<double> nearest(const std::vector<std::vector<double>>& points) const;
    /// The specification of the grey BRDF at a wavelength of the band. Throws UsageError beyond it,
    /// and between the wavelengths of the data if a parameter is free there.
    std::string specAt(double nanometres, std::span<const double> coefficients) const;

private:
    double scaled(std::size_t i, double curveValue, const ParametricSum& sum, double* slope) const;

    std::string spec_;
    bool isotropic_;
    std::vector<double> nanometres_;
    std::vector<ParametricSum> sums_;
    std::vector<LawStatement> laws_;
    std::vector<LawCurve> curves_;
    std::vector<std::size_t> first_;
    std::vector<double> lower_, upper_;
};

/// "a + b" with named metals replaced by n and k at a wavelength (metal_spec.h).
std::string sumAtWavelength(std::string_view sum, double nanometres);

/// The least-squares problem of a spectrum in the coefficients of a DispersedModel: the sum of the
/// FitProblems of its wavelengths, each linearised by the chain rule. With a slit the values are
/// readings, mixed among the wavelengths by `mix` (slitMatrix); the loss is then linear, without a
/// robust kernel, and problemAt gives the problems without the slit.
class DispersedProblem {
public:
    DispersedProblem(const FitSamples& samples, const DispersedModel& model, Loss::Kind loss,
                     std::vector<double> mix = {});

    const DispersedModel& model() const { return model_; }
    const FitSamples& samples() const { return samples_; }
    FitProblem& problemAt(std::size_t c) { return problems_[c]; }
    double normalisation() const { return normalisation_; }
    const std::vector<double>& mix() const { return mix_; }
    void setRobust(Robust robust, double scale);

    /// As FitProblem::joint.
    Equations joint(std::span<const double> coefficients, bool derivatives,
                    std::span<const double> inverse = {}) const;
    /// As FitProblem::weightedRows, of all values as one channel: every column is a coefficient.
    WeightedRows weightedRows(std::span<const double> coefficients) const;
    /// g(f) - g(measured): [channel * samples + k].
    std::vector<double> residuals(std::span<const double> coefficients) const;

private:
    WeightedRows mixedRows(std::span<const double> coefficients) const;
    Equations mixedEquations(std::span<const double> coefficients, bool derivatives,
                             std::span<const double> inverse) const;

    const FitSamples& samples_;
    const DispersedModel& model_;
    Loss::Kind loss_;
    std::vector<double> mix_;  ///< empty: no slit
    std::vector<FitSamples> channels_;
    std::vector<FitSamples> bare_;  ///< channels without weights, with a slit
    std::vector<FitProblem> problems_;
    double normalisation_ = 0;
};

}  // namespace hshfit::brdfs
