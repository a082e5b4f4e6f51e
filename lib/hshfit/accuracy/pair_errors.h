#pragma once

#include <hshfit/accuracy/metrics.h>
#include <hshfit/accuracy/pair_sample.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline accuracy {

/// A value for each row of metricCatalog(), in its order; none where it does not exist.
struct PairErrors {
    std::vector<std::optional<double>> values;
    /// Standard error of the value, from the replicates; none where it has no meaning (maximum,
    /// albedo, reciprocity).
    std::vector<std::optional<double>> uncertainty;
};

/// A reference BRDF at fixed pairs, and the errors of others against it. Immutable after it is
/// made; safe to use from many threads.
///
/// The metrics are those of metrics.h with means over the pairs; captured-energy counts f at the
/// same pairs. Two are found otherwise: albedo is the largest difference of the directional albedo
/// averaged over a stratum of cos(theta_o) and all azimuths, reciprocity the root mean square of
/// g(wi,wo) - g(wo,wi) over that of g for all pairs of 48 directions.
class PairReference {
public:
    /// Throws NumericError if the reference is not finite somewhere.
    PairReference(const Brdf& brdf, PairSample pairs);

    const PairSample& pairs() const { return pairs_; }
    std::span<const double> values() const { return values_; }  ///< as from evaluateOn
    /// Why metrics of squares without a cosine have no value; empty if they have.
    const std::string& noSquares() const { return noSquares_; }

    struct Result {
        PairErrors all;
        std::vector<PairErrors> bands;  ///< by elevation of wo; without values where no pair is
    };
    /// Errors of `g`, which has as many channels. On one thread.
    Result errorsOf(const Brdf& g) const;
    /// Of values at the pairs, as from evaluateOn; albedo as far as the pairs determine it.
    Result errorsOf(std::span<const double> g) const;

private:
    struct Part {
        std::vector<std::size_t> pairs;
        std::vector<double> f, cosines, weights;
    };
    Part partOf(std::vector<std::size_t> pairs) const;
    std::vector<std::optional<double>> metricsOf(const Part& part, std::span<const double> g) const;
    std::optional<double> albedoError(std::span<const double> g, std::size_t band) const;

    PairSample pairs_;
    std::size_t channels_;
    std::vector<double> values_;
    std::string noSquares_;
    Part all_;
    std::vector<Part> replicates_, bands_;
};

/// Root mean square of g(wi,wo) - g(wo,wi) over that of g, for all pairs of 48 directions.
double reciprocityError(const Brdf& g);

}  // namespace hshfit::inline accuracy
