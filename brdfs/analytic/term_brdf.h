#pragma once

#include <brdfs/rows/model.h>

#include <functional>
#include <utility>

namespace hshfit::brdfs {

/// One value, or three for R, G and B.
using Colour = std::vector<double>;

/// `f` applied to every value; of two colours, a grey one is combined with each value of the other.
Colour mapped(const Colour& a, const std::function<double(double)>& f);
Colour mapped(const Colour& a, const Colour& b, const std::function<double(double, double)>& f);
double largest(const Colour& a);
/// A diffuse albedo as a BRDF value.
Colour overPi(const Colour& a);
/// Weights of `count` terms, each with `colour` in its own channel and 0 elsewhere; for a
/// single term `colour` itself.
std::vector<Colour> eachInItsChannel(const Colour& colour, std::size_t count);

/// The constant of a TermBrdf and the weight of each term, for every channel.
struct TermWeights {
    Colour constant;
    std::vector<Colour> terms;
};

/// +inf becomes the largest double.
double atMostLargest(double value);

/// The hint for a lobe about the normal with these widths, in units of slope, along x and y.
Lobe halfwayLobe(double widthX, double widthY);

/// One call of TermBrdf::eval, for wo.z > 0: `constant` [channel], `weights` [channel][term].
struct TermBatch {
    static constexpr std::size_t maxTerms = 11, maxChannels = 3;

    const Direction& wo;
    DirectionBatch wi;
    double* out;
    std::size_t channels, terms;
    const double* constant;
    const double* weights;
};

/// The base of analytic models: a constant plus terms that all channels have in common,
///     f_c(wi, wo) = constant_c + sum_t weight_{t,c} T_t(wi, wo).
/// Grey if every colour has one value, else rgb. Values are clamped to [0, the largest double],
/// so that f is finite and non-negative for every pair of unit directions.
///
/// A model states its terms as a formula in any number type T (term_batch.h). `eval` uses the
/// widest vector instructions of the machine, for a single direction too: f of a direction has
/// the same bits at every position in a batch.
class TermBrdf : public Brdf, public HasSamplers {
public:
    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const final;
    /// f by double and the C++ library's functions, as a reference for tests of `eval`.
    void evalScalar(const Direction& wo, DirectionBatch wi, double* out) const;
    std::vector<Fact> facts() const override;
    Known samplers() const override { return known_; }

protected:
    /// `laws` hold for this instance: the laws of the model's table line, or more. `weights` has at
    /// most TermBatch::maxTerms entries.
    TermBrdf(const Model& model, const Parameters& parameters, Laws laws, const Colour& constant,
             const std::vector<Colour>& weights);
    TermBrdf(const Model& model, const Parameters& parameters, Laws laws,
             const TermWeights& weights)
        : TermBrdf(model, parameters, laws, weights.constant, weights.terms) {}

    /// Both fill `batch.out`: with vectors, and with double.
    virtual void evalBatch(const TermBatch& batch) const = 0;
    virtual void evalBatchScalar(const TermBatch& batch) const = 0;

private:
    TermBatch batch(const Direction& wo, const DirectionBatch& wi, double* out) const;

    std::string name_, model_, source_;
    Channels channels_;
    Laws laws_;
    std::vector<double> constant_;  ///< [channel]
    std::vector<double> weights_;   ///< [channel][term]
    std::size_t termCount_;
    Known known_;
};

/// A TermBrdf whose terms follow from a `Shape`, by functions (shape, batch) over vectors and over
/// double.
template <class Shape, auto byVectors, auto byDouble>
class ShapedBrdf : public TermBrdf {
protected:
    ShapedBrdf(const Model& model, const Parameters& parameters, const Laws& laws,
               const TermWeights& weights, Shape shape)
        : TermBrdf(model, parameters, laws, weights), shape_(std::move(shape)) {}

    void evalBatch(const TermBatch& batch) const final { byVectors(shape_, batch); }
    void evalBatchScalar(const TermBatch& batch) const final { byDouble(shape_, batch); }

    Shape shape_;
};

}  // namespace hshfit::brdfs
