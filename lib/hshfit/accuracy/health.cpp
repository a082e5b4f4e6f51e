#include <hshfit/accuracy/health.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace hshfit::inline accuracy {
namespace {

constexpr double albedoAngles[] = {0, 15, 30, 45, 60, 70, 80, 85};
constexpr double albedoAzimuths[] = {0, 45, 90, 135};

/// Point k of an additive recurrence in four dimensions: multiples of the powers of 1/g with
/// g^5 = g + 1, the generalised golden ratio (Roberts 2018).
std::array<double, 4> lowDiscrepancy(std::size_t k) {
    static const double g = [] {
        double x = 1.2;
        for (int i = 0; i < 60; ++i) x = std::pow(1 + x, 0.2);
        return x;
    }();
    std::array<double, 4> point;
    double power = 1;
    for (double& coordinate : point) {
        power /= g;
        const double turns = 0.5 + power * static_cast<double>(k + 1);
        coordinate = turns - std::floor(turns);
    }
    return point;
}

Direction ofSquare(double u, double v) {
    const double sine = std::sqrt(u * (2 - u));
    return {sine * std::cos(2 * pi * v), sine * std::sin(2 * pi * v), 1 - u};
}

/// Even k: uniform over both hemispheres. Odd k: by half and difference angles, none where one of
/// the directions is below the horizon.
std::optional<DirectionPair> pairNumber(std::size_t k) {
    const auto u = lowDiscrepancy(k / 2);
    if (k % 2 == 0) return DirectionPair{ofSquare(u[0], u[1]), ofSquare(u[2], u[3])};
    const DirectionPair pair =
        fromHalfDifference(pi / 2 * u[0] * u[0], 2 * pi * u[1], pi / 2 * u[2], 2 * pi * u[3]);
    if (pair.wi.z <= 0 || pair.wo.z <= 0) return std::nullopt;
    return pair;
}

bool isCovered(const Brdf& brdf, const Direction& wi, const Direction& wo) {
    unsigned char covered = 0;
    brdf.coverage(wo, {&wi.x, &wi.y, &wi.z, 1}, &covered);
    return covered != 0;
}

/// Contribution of one pair; summed in order afterwards.
struct PairResult {
    bool used = false, covered = false;
    std::uint64_t negative = 0, notFinite = 0;
    double difference = 0, sum = 0, largest = 0;
    std::size_t channel = 0;
    double value = 0, exchanged = 0;
};

PairResult examinePair(const Brdf& brdf, const DirectionPair& pair) {
    PairResult result{.used = true, .covered = isCovered(brdf, pair.wi, pair.wo)};
    const auto values = evaluate(brdf, pair.wi, pair.wo);
    for (double f : values) {
        if (!std::isfinite(f)) ++result.notFinite;
        if (f < 0) ++result.negative;
    }
    if (!result.covered || !isCovered(brdf, pair.wo, pair.wi)) return result;
    const auto exchanged = evaluate(brdf, pair.wo, pair.wi);
    const double cosines = pair.wi.z * pair.wo.z;
    for (std::size_t c = 0; c < values.size(); ++c) {
        const double difference = cosines * std::abs(values[c] - exchanged[c]);
        if (!std::isfinite(difference)) continue;
        result.difference += difference;
        result.sum += cosines * (std::abs(values[c]) + std::abs(exchanged[c]));
        if (difference <= result.largest) continue;
        result.largest = difference;
        result.channel = c;
        result.value = values[c];
        result.exchanged = exchanged[c];
    }
    return result;
}

void examinePairs(const Brdf& brdf, std::size_t count, Health& health) {
    std::vector<PairResult> results(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const auto& range) {
        for (std::size_t k = range.begin(); k < range.end(); ++k) {
            if (const auto pair = pairNumber(k)) results[k] = examinePair(brdf, *pair);
        }
    });
    std::size_t uniformPairs = 0, coveredPairs = 0;
    double difference = 0, sum = 0, largest = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const PairResult& result = results[k];
        if (!result.used) continue;
        ++health.pairs;
        if (k % 2 == 0) {
            ++uniformPairs;
            coveredPairs += result.covered;
        }
        health.values += brdf.channels().count();
        health.negative += result.negative;
        health.notFinite += result.notFinite;
        difference += result.difference;
        sum += result.sum;
        if (result.largest <= largest) continue;
        largest = result.largest;
        const DirectionPair pair = *pairNumber(k);
        health.worstExchange =
            Health::Exchange{pair.wi, pair.wo, result.channel, result.value, result.exchanged};
    }
    health.coverage = static_cast<double>(coveredPairs) / static_cast<double>(uniformPairs);
    if (sum > 0) health.reciprocityDefect = difference / sum;
}

double largestOf(const std::vector<Health::Albedo>& integrals) {
    double largest = 0;
    for (const Health::Albedo& integral : integrals)
        for (const double value : integral.values) largest = std::max(largest, value);
    return largest;
}

}  // namespace

double Health::largestAlbedo() const {
    return largestOf(albedos);
}

double Health::largestReflectance() const {
    return largestOf(reflectances);
}

bool Health::createsEnergy() const {
    return std::ranges::any_of(reflectances, [&](const Albedo& reflectance) {
        const double margin = std::max(reflectance.error, 2 * albedoTolerance);
        return std::ranges::any_of(reflectance.values,
                                   [&](double value) { return value > 1 + margin; });
    });
}

Health examine(const Brdf& brdf, const HealthOptions& options) {
    Health health;
    health.albedoTolerance = options.albedoTolerance;
    examinePairs(brdf, options.pairs, health);
    std::vector<Health::Albedo> directions;
    for (double theta : albedoAngles) {
        for (double phi : albedoAzimuths) {
            if (phi > 0 && (theta == 0 || brdf.laws().isotropic)) break;
            directions.push_back({.at = directionFromAngles(radians(theta), radians(phi))});
        }
    }
    const std::size_t count = directions.size();
    const bool reciprocal = brdf.laws().reciprocal;
    const AlbedoOptions how{.tolerance = options.albedoTolerance,
                            .maxEvaluations = options.albedoEvaluations / count};
    const std::size_t all = reciprocal ? count : 2 * count;
    health.albedos = health.reflectances = directions;
    std::atomic<std::size_t> done = 0, evaluations = 0;
    eachInParallel(all, [&](std::size_t i) {
        Health::Albedo& integral = i < count ? health.albedos[i] : health.reflectances[i - count];
        try {
            AlbedoEstimate found = i < count ? estimateAlbedo(brdf, integral.at, how)
                                             : estimateReflectance(brdf, integral.at, how);
            evaluations += found.evaluations;
            integral.values = std::move(found.values);
            integral.error = found.error;
            integral.converged = found.converged;
        } catch (const NumericError&) {
            integral.values.clear();  // reported as not finite
        }
        if (options.progress) options.progress(++done, all);
    });
    if (reciprocal) health.reflectances = health.albedos;
    health.albedoEvaluations = evaluations;
    return health;
}

}  // namespace hshfit::inline accuracy
