#include <hshfit/accuracy/pair_errors.h>

#include <hshfit/error.h>
#include <hshfit/projection/horizon.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hshfit::inline accuracy {
namespace {

constexpr std::size_t allBands = bandCount;

std::size_t rowOf(std::string_view name) {
    const auto catalog = metricCatalog();
    const auto row = std::find_if(catalog.begin(), catalog.end(),
                                  [&](const Metric& m) { return m.name == name; });
    return static_cast<std::size_t>(row - catalog.begin());
}

/// The reason why integrals of f^2 without a cosine do not exist, from the wo of a few groups.
std::string whyNoSquares(const Brdf& brdf, const PairSample& pairs) {
    constexpr std::size_t looks = 8;
    const std::size_t step = std::max<std::size_t>(1, pairs.wo.size() / looks);
    for (std::size_t g = 0; g < pairs.wo.size(); g += step) {
        const auto behaviour = horizonBehaviour(brdf, pairs.wo[g], Quantity::brdf);
        if (!behaviour.energyExists(Basis::Inner::solidAngle)) {
            return fmt::format(
                "f grows like cos(theta_i)^-{:.2f} towards the horizon: the integral of its square "
                "does not exist; relative-l2-cosine does",
                behaviour.exponent);
        }
    }
    return {};
}

/// The standard error of the mean of independent estimates.
std::optional<double> standardError(const std::vector<double>& estimates) {
    const auto count = static_cast<double>(estimates.size());
    if (estimates.size() < 2) return std::nullopt;
    const double mean = std::accumulate(estimates.begin(), estimates.end(), 0.0) / count;
    double squares = 0;
    for (const double estimate : estimates) squares += (estimate - mean) * (estimate - mean);
    return std::sqrt(squares / (count * (count - 1)));
}

}  // namespace

PairReference::PairReference(const Brdf& brdf, PairSample pairs)
    : pairs_(std::move(pairs)),
      channels_(brdf.channels().count()),
      values_(evaluateOn(brdf, pairs_)),
      noSquares_(whyNoSquares(brdf, pairs_)) {
    brdf.checkIntact();
    for (const double value : values_) {
        if (!std::isfinite(value)) {
            throw NumericError(
                fmt::format("{} is not finite at some pairs of directions above the "
                            "horizon: there is nothing to compare with",
                            brdf.name()));
        }
    }
    std::vector<std::size_t> every(pairs_.size());
    std::iota(every.begin(), every.end(), std::size_t{0});
    all_ = partOf(every);
    std::vector<std::vector<std::size_t>> byReplicate(static_cast<std::size_t>(pairs_.replicates)),
        byBand(bandCount);
    for (std::size_t g = 0; g < pairs_.wo.size(); ++g) {
        const std::size_t band = bandOf(pairs_.wo[g]);
        for (std::size_t k = pairs_.first[g]; k < pairs_.first[g + 1]; ++k) {
            byBand[band].push_back(k);
            byReplicate[pairs_.replicate[k]].push_back(k);
        }
    }
    for (auto& list : byReplicate) replicates_.push_back(partOf(std::move(list)));
    for (auto& list : byBand) bands_.push_back(partOf(std::move(list)));
}

PairReference::Part PairReference::partOf(std::vector<std::size_t> pairs) const {
    Part part;
    for (const std::size_t k : pairs) {
        part.cosines.push_back(pairs_.z[k]);
        part.weights.push_back(pairs_.weights[k]);
    }
    for (std::size_t c = 0; c < channels_; ++c) {
        for (const std::size_t k : pairs) part.f.push_back(values_[c * pairs_.size() + k]);
    }
    part.pairs = std::move(pairs);
    return part;
}

std::vector<std::optional<double>> PairReference::metricsOf(const Part& part,
                                                            std::span<const double> g) const {
    std::vector<double> theirs;
    theirs.reserve(part.f.size());
    for (std::size_t c = 0; c < channels_; ++c) {
        for (const std::size_t k : part.pairs) theirs.push_back(g[c * pairs_.size() + k]);
    }
    std::vector<std::optional<double>> values;
    for (const MetricValue& value : compareSamples(part.f, theirs, part.cosines, part.weights)) {
        const bool exists = !value.metric->squaresWithoutCosine || noSquares_.empty();
        values.push_back(exists ? value.value : std::nullopt);
    }
    return values;
}

std::optional<double> PairReference::albedoError(std::span<const double> g,
                                                 std::size_t band) const {
    if (pairs_.stratum.empty()) return std::nullopt;
    const std::size_t strata = 1 + *std::max_element(pairs_.stratum.begin(), pairs_.stratum.end());
    std::vector<double> difference(strata * channels_), weight(strata);
    for (std::size_t group = 0; group < pairs_.wo.size(); ++group) {
        if (band != allBands && bandOf(pairs_.wo[group]) != band) continue;
        const std::size_t s = pairs_.stratum[group];
        for (std::size_t k = pairs_.first[group]; k < pairs_.first[group + 1]; ++k) {
            const double projected = pairs_.weights[k] * pairs_.z[k];
            weight[s] += pairs_.weights[k];
            for (std::size_t c = 0; c < channels_; ++c) {
                const std::size_t at = c * pairs_.size() + k;
                difference[s * channels_ + c] += projected * (g[at] - values_[at]);
            }
        }
    }
    double largest = 0;
    for (std::size_t k = 0; k < difference.size(); ++k) {
        if (weight[k / channels_] == 0) continue;
        largest = std::max(largest, 2 * pi * std::abs(difference[k]) / weight[k / channels_]);
    }
    return largest;
}

PairReference::Result PairReference::errorsOf(std::span<const double> g) const {
    Result result;
    result.all.values = metricsOf(all_, g);
    std::vector<std::vector<double>> estimates(result.all.values.size());
    for (const Part& replicate : replicates_) {
        const auto values = metricsOf(replicate, g);
        for (std::size_t m = 0; m < values.size(); ++m) {
            if (values[m]) estimates[m].push_back(*values[m]);
        }
    }
    const std::size_t maximum = rowOf("maximum"), albedo = rowOf("albedo");
    for (std::size_t m = 0; m < estimates.size(); ++m) {
        const bool complete = m != maximum && estimates[m].size() == replicates_.size();
        result.all.uncertainty.push_back(complete ? standardError(estimates[m]) : std::nullopt);
    }
    result.all.values[albedo] = albedoError(g, allBands);
    for (std::size_t b = 0; b < bands_.size(); ++b) {
        PairErrors band;
        if (!bands_[b].pairs.empty()) {
            band.values = metricsOf(bands_[b], g);
            band.values[albedo] = albedoError(g, b);
        }
        result.bands.push_back(std::move(band));
    }
    return result;
}

PairReference::Result PairReference::errorsOf(const Brdf& g) const {
    Result result = errorsOf(evaluateOn(g, pairs_, true));
    result.all.values[rowOf("reciprocity")] = reciprocityError(g);
    return result;
}

double reciprocityError(const Brdf& g) {
    constexpr std::size_t count = 48;
    const std::size_t channels = g.channels().count();
    std::vector<double> x, y, z;
    const double golden = pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < count; ++k) {
        const auto at = static_cast<double>(k);
        const Direction d = directionFromAngles(std::acos((at + 0.5) / count), at * golden);
        x.push_back(d.x);
        y.push_back(d.y);
        z.push_back(d.z);
    }
    std::vector<double> values(count * count * channels);  // [wo][channel][wi]
    for (std::size_t o = 0; o < count; ++o) {
        g.eval({x[o], y[o], z[o]}, {x.data(), y.data(), z.data(), count},
               values.data() + o * channels * count);
    }
    double defect = 0, norm = 0;
    for (std::size_t o = 0; o < count; ++o) {
        for (std::size_t i = 0; i < o; ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                const double there = values[(o * channels + c) * count + i];
                const double back = values[(i * channels + c) * count + o];
                defect += (there - back) * (there - back);
                norm += (there * there + back * back) / 2;
            }
        }
    }
    return norm > 0 ? std::sqrt(defect / norm) : 0;
}

}  // namespace hshfit::inline accuracy
