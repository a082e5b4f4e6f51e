#pragma once

#include <brdfs/analytic/model_columns.h>
#include <brdfs/fit/free_parameters.h>
#include <hshfit/brdf/brdf.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A free parameter that f is not linear in. A fit moves `u` = value, or ln(value + offset) if
/// logarithmic.
struct ShapeParameter {
    std::size_t term = 0;  ///< of the sum
    std::string name;      ///< "ggx.alpha": parameterName
    FreeParameter free;
    double offset = 0;  ///< keeps the logarithm finite where the least value is 0

    double toScale(double value) const;
    double toValue(double u) const;
    double lower() const { return toScale(free.min); }
    double upper() const { return toScale(free.max); }
    double step() const;  ///< of u, for differences
    /// Derivative of the value by u.
    double slope(double value) const { return free.logarithmic ? value + offset : 1; }
};

/// A free parameter with a value per channel: f is linear in it, whatever the shape, or, of a term
/// with functions of its own in each channel, is linearised about its value. min is 0.
struct LinearParameter {
    std::size_t term = 0;
    std::string name;
    std::string key;
    double min = 0, max = 0;
    bool exact = true;  ///< f is linear in it
};

/// The shape-dependent functions of which f is a sum, for one set of shape values:
///     f_c = column_0 + sum_k linear_{k,c} column_k
/// for the terms [first, last) of the sum.
class Columns {
public:
    /// out[k * wi.count + j] for the columns of these terms: 0 first, then the linear ones in
    /// order. Thread-safe.
    void eval(const Direction& wo, DirectionBatch wi, double* out) const;
    std::size_t count() const { return count_; }

private:
    friend class ParametricSum;
    struct Probe {
        std::unique_ptr<Brdf> brdf;  ///< channel i has linear parameter first + i - 1 at its unit
        std::size_t base = 0;        ///< of the term: its first column less one
        std::size_t linear = 0;      ///< how many of them
        bool first = true;           ///< of the term: adds to column 0
        std::vector<double> unit;
    };
    std::vector<Probe> probes_;
    std::size_t count_ = 1;
};

/// A sum of catalog models with free parameters, "MODEL[:key=value,…][+MODEL…]".
class ParametricSum {
public:
    /// Throws UsageError as parsing does, or if nothing is free. `channel`: of R, G and B that the
    /// first one of the samples is. `coloured`: albedos have a value for each channel although f is
    /// not linear in them (FreeParameter::albedo), if f in each channel depends on that value
    /// alone.
    ParametricSum(std::string_view spec, bool isotropic, std::size_t channel = 0,
                  bool coloured = false);

    const std::string& spec() const { return spec_; }
    const std::vector<ShapeParameter>& shapes() const { return shapes_; }
    const std::vector<LinearParameter>& linears() const { return linears_; }
    /// Indices of the linear parameters of the term that shape j belongs to.
    const std::vector<std::size_t>& linearsOf(std::size_t shape) const;
    std::size_t termCount() const { return terms_.size(); }
    /// Indices of the shapes of a term, consecutive, and of its linear parameters, likewise.
    const std::vector<std::size_t>& shapesOfTerm(std::size_t term) const;
    const std::vector<std::size_t>& linearsOfTerm(std::size_t term) const;
    /// Columns of one term, at values (not u) of all shapes, by its model's formula, with
    /// derivatives by its shapes if asked for. Null: by differences of Brdf::eval.
    std::unique_ptr<ModelColumns> formulaColumns(std::size_t term, std::span<const double> shapes,
                                                 bool derivatives) const;
    /// Whether a term has functions of its own in each channel: by its model (Model::channelwise),
    /// or because of an albedo in which f is not linear.
    bool channelwise(std::size_t term) const { return terms_[term].channelwise; }
    bool channelwise() const;
    /// Whether a model has, whatever its colours.
    bool hasColouredModel() const { return hasColouredModel_; }
    bool coloured() const { return coloured_; }
    /// Names of the albedos (FreeParameter::albedo) that are one number for all channels.
    std::vector<std::string> sharedAlbedos() const;
    /// f of such a term in one channel of the samples, at values of all shapes and of that
    /// channel's linear parameters, with derivatives by its shapes if asked for, then by its linear
    /// parameters.
    std::unique_ptr<ModelColumns> channelColumns(std::size_t term, std::size_t channel,
                                                 std::span<const double> shapes,
                                                 std::span<const double> linears,
                                                 bool derivatives) const;
    bool byFormula(std::size_t term) const { return terms_[term].byFormula; }
    /// For tests: everything through Brdf::eval.
    void forgetFormulas();
    /// Whether every term vanishes where its linear parameters are 0.
    bool scalable() const { return scalable_; }

    /// Columns of one term, at values (not u) of all shapes.
    Columns columnsOf(std::size_t term, std::span<const double> shapes) const;

    /// The specification with values filled in. `shapes[c]` for each channel c (one: shared),
    /// linear[k * channels + c]. Throws UsageError if shapes differ between channels in a number
    /// of a term that does not vanish with its linear parameters.
    std::string filledIn(const std::vector<std::vector<double>>& shapes,
                         std::span<const double> linear, std::size_t channels) const;

private:
    struct Term {
        const Model* model = nullptr;
        Parameters stated;                 ///< as given, and held
        std::vector<std::size_t> shapes;   ///< indices
        std::vector<std::size_t> linears;  ///< indices
        std::vector<std::vector<std::string>> shapeKeys;
        std::vector<std::string> linearKeys;
        bool byFormula = false;
        bool channelwise = false;
    };
    /// The stated parameters, with the shapes at these values.
    Parameters shaped(const Term& term, std::span<const double> shapes) const;
    void addProbes(const Term& term, std::span<const double> shapes, Columns& columns,
                   std::size_t base) const;
    bool vanishes(const Term& term) const;
    std::string filledTerm(const Term& term, const std::vector<std::vector<double>>& shapes,
                           std::span<const double> linear, std::size_t channels) const;

    std::string spec_;
    std::vector<Term> terms_;
    std::vector<ShapeParameter> shapes_;
    std::vector<LinearParameter> linears_;
    bool scalable_ = true;
    bool hasColouredModel_ = false;
    std::size_t channel_ = 0;
    bool coloured_ = false;
};

/// Whether a term of a specification has functions of its own in each channel.
bool isChannelwise(std::string_view spec);

}  // namespace hshfit::brdfs
