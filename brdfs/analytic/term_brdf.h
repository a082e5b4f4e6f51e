#pragma once

#include <brdfs/catalog.h>

#include <functional>

namespace hshfit::brdfs {

/// One value, or three for R, G and B.
using Colour = std::vector<double>;

/// `f` applied to every value; of two colours, where one is grey it joins each value of the other.
Colour mapped(const Colour& a, const std::function<double(double)>& f);
Colour mapped(const Colour& a, const Colour& b, const std::function<double(double, double)>& f);
double largest(const Colour& a);
/// A diffuse albedo as a BRDF value.
Colour overPi(const Colour& a);
/// Weights of `count` terms, each of which has `colour` in its own channel only; of a single term,
/// `colour` itself.
std::vector<Colour> eachInItsChannel(const Colour& colour, std::size_t count);

/// What the analytic models share: a constant plus terms that all channels have in common,
///     f_c(wi, wo) = constant_c + sum_t weight_{t,c} T_t(wi, wo).
/// Grey if every colour has one value, else rgb. Values beyond the largest double are cut to it,
/// and to 0 from below, so that f is finite and non-negative for every pair of unit directions.
class TermBrdf : public Brdf {
public:
    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const final;
    std::vector<Fact> facts() const override;

protected:
    /// `laws` of this instance: those of the table line, or more. At most `maxTerms` weights.
    TermBrdf(const Model& model, const Parameters& parameters, Laws laws, const Colour& constant,
             const std::vector<Colour>& weights);

    /// out[t * wi.count + k] = T_t(wi_k, wo), for wo.z > 0 and at most `blockSize` directions. What
    /// is written where wi.z <= 0 is ignored; +inf is cut to the largest double; never NaN above.
    virtual void terms(const Direction& wo, DirectionBatch wi, double* out) const = 0;

    static constexpr std::size_t blockSize = 256, maxTerms = 4;

private:
    std::string name_, model_, source_;
    Channels channels_;
    Laws laws_;
    std::vector<double> constant_;  ///< [channel]
    std::vector<double> weights_;   ///< [channel][term]
    std::size_t termCount_;
};

/// +inf becomes the largest double, so that a factor 0 met later gives 0 and not NaN.
double bounded(double value);

}  // namespace hshfit::brdfs
