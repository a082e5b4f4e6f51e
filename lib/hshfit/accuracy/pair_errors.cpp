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
    all_ = divisionOf(every);
    std::vector<std::vector<std::size_t>> byBand(bandCount), byZone(zoneCount);
    for (std::size_t g = 0; g < pairs_.wo.size(); ++g) {
        const std::size_t band = bandOf(pairs_.wo[g]);
        for (std::size_t k = pairs_.first[g]; k < pairs_.first[g + 1]; ++k) {
            byBand[band].push_back(k);
            for (std::size_t z = 0; z < zoneCount; ++z) {
                const auto zone = static_cast<PairZone>(z);
                if (inZone(zone, pairs_.incoming(k), pairs_.wo[g])) byZone[z].push_back(k);
            }
        }
    }
    for (auto& list : byBand) bands_.push_back(partOf(std::move(list)));
    for (const auto& list : byZone) zones_.push_back(divisionOf(list));
}

PairReference::Division PairReference::divisionOf(const std::vector<std::size_t>& pairs) const {
    Division division;
    std::vector<std::vector<std::size_t>> lists(static_cast<std::size_t>(pairs_.replicates));
    for (const std::size_t k : pairs) lists[pairs_.replicate[k]].push_back(k);
    for (auto& list : lists) division.replicates.push_back(partOf(std::move(list)));
    division.whole = partOf(pairs);
    return division;
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

PairReference::AlbedoError PairReference::albedoError(std::span<const double> g,
                                                      std::size_t band) const {
    if (pairs_.stratum.empty()) return {};
    const std::size_t strata = 1 + *std::max_element(pairs_.stratum.begin(), pairs_.stratum.end());
    const auto replicates = static_cast<std::size_t>(pairs_.replicates);
    const std::size_t rows = strata * channels_;
    // The last row of each is all replicates together.
    std::vector<std::vector<double>> difference(replicates + 1, std::vector<double>(rows)),
        weight(replicates + 1, std::vector<double>(strata));
    std::vector<double> reference(rows);
    for (std::size_t group = 0; group < pairs_.wo.size(); ++group) {
        if (band != allBands && bandOf(pairs_.wo[group]) != band) continue;
        const std::size_t s = pairs_.stratum[group];
        for (std::size_t k = pairs_.first[group]; k < pairs_.first[group + 1]; ++k) {
            const double projected = pairs_.weights[k] * pairs_.z[k];
            for (std::size_t c = 0; c < channels_; ++c)
                reference[s * channels_ + c] += projected * values_[c * pairs_.size() + k];
            for (const std::size_t r : {std::size_t{pairs_.replicate[k]}, replicates}) {
                weight[r][s] += pairs_.weights[k];
                for (std::size_t c = 0; c < channels_; ++c) {
                    const std::size_t at = c * pairs_.size() + k;
                    difference[r][s * channels_ + c] += projected * (g[at] - values_[at]);
                }
            }
        }
    }
    const auto albedo = [&](std::size_t r, std::size_t row) {
        return 2 * pi * difference[r][row] / weight[r][row / channels_];
    };
    AlbedoError result{.value = 0.0, .uncertainty = 0.0};
    for (std::size_t row = 0; row < rows; ++row) {
        if (weight[replicates][row / channels_] == 0) continue;
        const double here = std::abs(albedo(replicates, row));
        if (!(here > *result.value)) continue;
        std::vector<double> estimates;
        for (std::size_t r = 0; r < replicates; ++r) {
            if (weight[r][row / channels_] > 0) estimates.push_back(albedo(r, row));
        }
        result = {here, standardError(estimates),
                  2 * pi * reference[row] / weight[replicates][row / channels_], row / channels_};
    }
    return result;
}

double PairReference::energyLeftOn(const Part& part, std::span<const double> g) const {
    double left = 0, whole = 0;
    for (std::size_t c = 0; c < channels_; ++c) {
        for (std::size_t n = 0; n < part.pairs.size(); ++n) {
            const std::size_t k = part.pairs[n];
            const double cosines = part.cosines[n] * pairs_.outgoing(k).z;
            const double f = part.f[c * part.pairs.size() + n];
            left += part.weights[n] * std::pow((g[c * pairs_.size() + k] - f) * cosines, 2);
            whole += part.weights[n] * std::pow(f * cosines, 2);
        }
    }
    return whole > 0 ? left / whole : std::nan("");
}

PairErrors PairReference::errorsOn(const Division& division, std::span<const double> g) const {
    PairErrors errors;
    if (division.whole.pairs.empty()) return errors;
    errors.values = metricsOf(division.whole, g);
    std::vector<std::vector<double>> estimates(errors.values.size());
    for (const Part& replicate : division.replicates) {
        if (replicate.pairs.empty()) continue;
        const auto values = metricsOf(replicate, g);
        for (std::size_t m = 0; m < values.size(); ++m) {
            if (values[m]) estimates[m].push_back(*values[m]);
        }
    }
    const std::size_t maximum = rowOf("maximum");
    for (std::size_t m = 0; m < estimates.size(); ++m) {
        const bool complete = m != maximum && estimates[m].size() == division.replicates.size();
        errors.uncertainty.push_back(complete ? standardError(estimates[m]) : std::nullopt);
    }
    double largest = -1;
    for (const std::size_t k : division.whole.pairs) {
        for (std::size_t c = 0; c < channels_; ++c) {
            const std::size_t at = c * pairs_.size() + k;
            const double here = std::abs(g[at] - values_[at]) * pairs_.z[k];
            if (!(here > largest)) continue;
            largest = here;
            errors.largest = {pairs_.incoming(k), pairs_.outgoing(k)};
        }
    }
    return errors;
}

PairReference::Result PairReference::errorsOf(std::span<const double> g) const {
    Result result;
    const std::size_t albedo = rowOf("albedo");
    result.all = errorsOn(all_, g);
    const AlbedoError found = albedoError(g, allBands);
    result.all.values[albedo] = found.value;
    result.all.uncertainty[albedo] = found.uncertainty;
    result.albedoThere = found.there;
    for (std::size_t group = 0; group < pairs_.stratum.size(); ++group) {
        if (pairs_.stratum[group] != found.stratum) continue;
        const double theta = polarAngle(pairs_.wo[group]);
        result.albedoFrom = result.albedoTo == 0 ? theta : std::min(result.albedoFrom, theta);
        result.albedoTo = std::max(result.albedoTo, theta);
    }
    for (std::size_t b = 0; b < bands_.size(); ++b) {
        PairErrors band;
        if (!bands_[b].pairs.empty()) {
            band.values = metricsOf(bands_[b], g);
            band.values[albedo] = albedoError(g, b).value;
        }
        result.bands.push_back(std::move(band));
    }
    std::vector<double> left;
    for (const Part& replicate : all_.replicates) {
        if (!replicate.pairs.empty()) left.push_back(energyLeftOn(replicate, g));
    }
    result.energyLeft = energyLeftOn(all_.whole, g);
    result.energyLeftError = standardError(left).value_or(std::nan(""));
    for (const Division& zone : zones_) result.zones.push_back(errorsOn(zone, g));
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

PairSummary summaryOf(const PairSample& pairs, const PairReference::Result& errors) {
    const auto valueOf = [](const PairErrors& each, std::string_view name) {
        const std::size_t row = rowOf(name);
        const double none = std::nan("");
        if (each.values.empty()) return PairSummary::Value{none, none};
        const std::optional<double> error =
            each.uncertainty.empty() ? std::nullopt : each.uncertainty[row];
        return PairSummary::Value{each.values[row].value_or(none), error.value_or(none)};
    };
    PairSummary summary{.pairs = pairs.size(),
                        .meanLog = valueOf(errors.all, "nbrdf"),
                        .relativeL2 = valueOf(errors.all, "relative-l2-cosine"),
                        .energyLeft = {errors.energyLeft, errors.energyLeftError},
                        .zones = {},
                        .maximum = valueOf(errors.all, "maximum").value,
                        .at = errors.all.largest.value_or(DirectionPair{}),
                        .albedo = valueOf(errors.all, "albedo"),
                        .albedoThere = errors.albedoThere,
                        .albedoFrom = errors.albedoFrom,
                        .albedoTo = errors.albedoTo};
    for (std::size_t z = 0; z < zoneCount; ++z) {
        summary.zones[z] = valueOf(errors.zones[z], "nbrdf");
    }
    return summary;
}

PairSummary summaryOf(const PairReference& reference, const Brdf& g) {
    return summaryOf(reference.pairs(), reference.errorsOf(evaluateOn(g, reference.pairs())));
}

PairSummary summaryOf(const Brdf& brdf, const Brdf& g) {
    return summaryOf(PairReference(brdf, spreadPairs()), g);
}

std::string textOf(const PairSummary& summary) {
    const auto text = [](const PairSummary::Value& v) {
        if (!std::isfinite(v.value)) return std::string("none");
        return fmt::format("{:.3g} +- {:.1g}", v.value, v.error);
    };
    const auto place = [](const Direction& d) {
        return fmt::format("{:.2f},{:.2f}", degrees(polarAngle(d)), degrees(azimuth(d)));
    };
    std::string zones;
    for (std::size_t z = 0; z < zoneCount; ++z) {
        zones += fmt::format(", {} {}", zoneNames[z], text(summary.zones[z]));
    }
    return fmt::format(
        "mean log error {} over {} pairs{}\n"
        "relative L2 of f cos(theta_i) {}; share of the energy of f cos cos that is left {}\n"
        "largest |g - f| cos(theta_i) {:.3g} at wi {}, wo {}; albedo off by {} at most, of {:.3g} "
        "at "
        "theta_o {:.4g} to {:.4g}\n",
        text(summary.meanLog), summary.pairs, zones, text(summary.relativeL2),
        text(summary.energyLeft), summary.maximum, place(summary.at.wi), place(summary.at.wo),
        text(summary.albedo), summary.albedoThere, degrees(summary.albedoFrom),
        degrees(summary.albedoTo));
}

}  // namespace hshfit::inline accuracy
