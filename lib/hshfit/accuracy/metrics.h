#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/outgoing.h>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline accuracy {

/// One row of the table of error metrics between a reference f and an approximation g.
/// With c = cos(theta_i); means are over wi (d omega), the outgoing set's solid angles and
/// channels. A metric that takes a logarithm or a root of g clamps g at 0 first, as renderers do.
struct Metric {
    std::string_view name;
    std::string_view help;
    std::string_view source;
    /// Uses f and g without the cosine in an integral of squares, which may not exist.
    bool squaresWithoutCosine;
};

/// All metrics, in the order in which they are listed.
std::span<const Metric> metricCatalog();

/// "all" or a comma-separated list. Throws UsageError that names the known ones.
std::vector<const Metric*> selectMetrics(std::string_view names);

struct MetricValue {
    const Metric* metric = nullptr;
    std::optional<double> value;  ///< none where it does not exist
    double error = 0;             ///< change between the last two quadrature levels
    std::string reason;           ///< why there is no value
    /// The directions of the largest error (maximum and albedo only).
    std::optional<Direction> wi, wo;
};

/// The outgoing directions over which BRDFs are compared unless others are named: 16 elevations, or
/// 16 x 16 texels where one of them is anisotropic.
OutgoingSet comparedOutgoing(bool isotropic);

struct CompareOptions {
    /// Two quadrature levels are compared; each level has 2.25 times the points of the one before.
    int level = 3;
    /// Names of f and g in reasons; their own if empty. A coefficient file has the name of its
    /// source.
    std::string reference = {}, approximation = {};
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Every metric asked for, of `g` against `f`, over `outgoing`. A grey BRDF compares with any
/// channels; otherwise the channels have to agree (UsageError).
std::vector<MetricValue> compare(const Brdf& f, const Brdf& g, const OutgoingSet& outgoing,
                                 std::span<const Metric* const> metrics,
                                 const CompareOptions& options = {});

/// Every metric of values g against f at the same samples, [channel * cosines.size() + sample],
/// with c = `cosines` and weights in place of solid angles. Albedo and reciprocity need more than
/// samples and have no value.
std::vector<MetricValue> compareSamples(std::span<const double> f, std::span<const double> g,
                                        std::span<const double> cosines,
                                        std::span<const double> weights);

}  // namespace hshfit::inline accuracy
