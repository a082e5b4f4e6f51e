#pragma once

#include <hshfit/accuracy/metrics.h>
#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/brdf/directions.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline accuracy {

/// A value for each row of metricCatalog(), in its order; none where it does not exist.
struct PairErrors {
    std::vector<std::optional<double>> values;
    /// Standard error of the value, from the replicates; none where it has no meaning (maximum,
    /// reciprocity).
    std::vector<std::optional<double>> uncertainty;
    /// The pair of the maximum.
    std::optional<DirectionPair> largest = {};
};

/// A reference BRDF at fixed pairs, and the errors of others against it. Immutable after it is
/// made; safe to use from many threads.
///
/// The metrics are the ones of metrics.h with means over the pairs; captured-energy counts f at the
/// same pairs. Two are found otherwise: albedo is the largest difference of the directional albedo
/// averaged over a stratum of cos(theta_o) of a sixteenth or so and all azimuths, reciprocity the
/// root mean square of g(wi,wo) - g(wo,wi) relative to g, for all pairs of 48 directions.
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
        /// By PairZone, without values where no pair is; with uncertainties, without albedo.
        std::vector<PairErrors> zones = {};
        /// The albedo of the reference where `all` has its largest difference, and the theta_o of
        /// that stratum.
        double albedoThere = 0, albedoFrom = 0, albedoTo = 0;
        /// Over all pairs, as in PairSummary.
        double energyLeft = 0, energyLeftError = 0;
    };
    /// Errors of `g`, which has as many channels. On one thread.
    Result errorsOf(const Brdf& g) const;
    /// The errors of values at the pairs (evaluateOn); albedo as far as the pairs determine it.
    Result errorsOf(std::span<const double> g) const;

private:
    struct Part {
        std::vector<std::size_t> pairs;
        std::vector<double> f, cosines, weights;
    };
    /// Pairs, and what each replicate has of them.
    struct Division {
        Part whole;
        std::vector<Part> replicates;
    };
    Part partOf(std::vector<std::size_t> pairs) const;
    Division divisionOf(const std::vector<std::size_t>& pairs) const;
    double energyLeftOn(const Part& part, std::span<const double> g) const;
    PairErrors errorsOn(const Division& division, std::span<const double> g) const;
    std::vector<std::optional<double>> metricsOf(const Part& part, std::span<const double> g) const;
    /// The largest difference, its standard error, the albedo of the reference there, the stratum.
    struct AlbedoError {
        std::optional<double> value, uncertainty;
        double there = 0;
        std::size_t stratum = 0;
    };
    AlbedoError albedoError(std::span<const double> g, std::size_t band) const;

    PairSample pairs_;
    std::size_t channels_;
    std::vector<double> values_;
    std::string noSquares_;
    Division all_;
    std::vector<Part> bands_;
    std::vector<Division> zones_;
};

/// Root mean square of g(wi,wo) - g(wo,wi) relative to g, for all pairs of 48 directions.
double reciprocityError(const Brdf& g);

/// The errors of a form that every command prints, so that no mean hides a maximum.
struct PairSummary {
    struct Value {
        double value = 0, error = 0;  ///< with its standard error
    };
    std::size_t pairs = 0;
    Value meanLog;     ///< mean |ln(1 + f c) - ln(1 + g c)|
    Value relativeL2;  ///< root of the integral of ((g - f) c)^2 over (f c)^2
    /// The share that g misses of the energy of f cos(theta_i) cos(theta_o), which exists for every
    /// BRDF of finite albedo: the integral of (g - f)^2 over the integral of f^2.
    Value energyLeft;
    std::array<Value, zoneCount> zones;   ///< the same by PairZone
    double maximum = 0;                   ///< of |g - f| c
    DirectionPair at;                     ///< where that is
    Value albedo;                         ///< largest difference of directional albedo
    double albedoThere = 0;               ///< the albedo of the reference there
    double albedoFrom = 0, albedoTo = 0;  ///< and theta_o, of the pairs that it is averaged over
};
PairSummary summaryOf(const PairSample& pairs, const PairReference::Result& errors);
PairSummary summaryOf(const PairReference& reference, const Brdf& g);
/// Errors of `g` on spreadPairs(): the same numbers for every caller. Throws as PairReference does.
PairSummary summaryOf(const Brdf& brdf, const Brdf& g);
/// Three lines without indentation, each ended.
std::string textOf(const PairSummary& summary);

}  // namespace hshfit::inline accuracy
