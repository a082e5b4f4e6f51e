#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/parametric_sum.h>

#include <span>
#include <vector>

namespace hshfit::brdfs {

/// The columns of a parametric sum at samples, and their derivatives by the shapes' u, for one u:
/// column 0 and the linear ones, then for each shape j its derivative of column 0 and of the linear
/// ones of its term. By the model's formula where it has columns, else through Brdf::eval with
/// central differences. A term with functions of its own in each channel is linearised about
/// values of the linear parameters: at these, f and its derivatives are exact.
class ColumnBlocks {
public:
    ColumnBlocks(const FitSamples& samples, const ParametricSum& sum, std::span<const double> u,
                 bool derivatives, std::size_t channel = 0, std::vector<double> linears = {});

    std::size_t count() const { return count_; }
    /// Where the derivatives by shape j stand: of column 0, then of linearsOf(j).
    std::size_t derivative(std::size_t shape) const { return first_[shape]; }

    static constexpr std::size_t blockSize = 1024;
    /// out[column * size + k] for samples [begin, begin + size), size <= blockSize. Thread-safe.
    void fill(std::size_t begin, std::size_t size, double* out) const;

private:
    struct Difference {
        Columns above, below;
        double inverse = 0;
    };
    struct Term {
        std::unique_ptr<ModelColumns> formula;
        std::vector<double> slopes;  ///< derivatives of these by u
        Columns columns;
        std::vector<Difference> differences;
        std::size_t linears = 0, firstLinear = 0, firstSlope = 0;
        bool channelwise = false;
    };
    /// The columns of f at pairs, at most blockSize of them.
    void fillPairs(const PairPlaces& pairs, double* out) const;
    void fillSums(std::size_t begin, std::size_t size, double* out) const;
    void fillByFormula(const Term& term, const PairPlaces& pairs, double* out) const;
    void fillLinearised(const Term& term, const PairPlaces& pairs, double* out) const;
    void fillByDifferences(const Term& term, const PairPlaces& pairs, double* out) const;

    const FitSamples& samples_;
    std::vector<double> linears_;  ///< about which f is linearised
    std::vector<Term> terms_;
    std::vector<std::size_t> first_;
    std::size_t count_;
};

}  // namespace hshfit::brdfs
