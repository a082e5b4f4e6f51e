#include <hshfit/representation/halfway/internal/halfway_albedo.h>

#include <hshfit/accuracy/pair_sample.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr int outgoingStrata = 12, incomingPairs = 512;
/// Azimuths of wo in a stratum where f depends on them.
constexpr int azimuthStrata = 6;
/// The mean square of relative errors of albedo that needs no correction: half a per cent.
constexpr double rightEnough = 2.5e-5;
/// exp of more than that is cut off: a step of the descent may go astray.
constexpr double greatestExponent = 60;

/// Albedo of one stratum and its derivatives by the coefficients, [term][channel].
void sumStratum(const HalfwayTerms& terms, const HalfwayAlbedo& albedo,
                const std::vector<double>& caps, const HalfwayValues& values, std::size_t stratum,
                double* sums, HalfwayValues& slopes) {
    const Eigen::Index channels = values.cols();
    Eigen::VectorXd products(values.rows());
    for (std::size_t k = albedo.first[stratum]; k < albedo.first[stratum + 1]; ++k) {
        terms.evaluate(albedo.points[k], products.data());
        for (Eigen::Index c = 0; c < channels; ++c) {
            const double y = std::min(products.dot(values.col(c)), greatestExponent);
            if (!(y > 0)) continue;
            const double f = std::expm1(y);
            const double cap = caps.empty() ? std::numeric_limits<double>::infinity()
                                            : std::exp(caps[k * static_cast<std::size_t>(channels) +
                                                            static_cast<std::size_t>(c)]);
            sums[c] += albedo.weights[k] * std::min(f, cap);
            if (f < cap) slopes.col(c) += albedo.weights[k] * (f + 1) * products;
        }
    }
}

}  // namespace

double HalfwayAlbedo::greatestMean() const {
    double greatest = 0;
    for (std::size_t c = 0; c < channels(); ++c) {
        double mean = 0;
        for (std::size_t s = 0; s < strata(); ++s) mean += shares[s] * targets[s * channels() + c];
        greatest = std::max(greatest, mean);
    }
    return greatest;
}

HalfwayAlbedo albedoOf(const Brdf& brdf, bool reciprocal) {
    const int replicates = brdf.laws().isotropic ? 1 : azimuthStrata;
    const PairSample pairs = spreadPairs(
        {.replicates = replicates, .outgoing = outgoingStrata, .incoming = incomingPairs});
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values = evaluateOn(brdf, pairs);
    HalfwayAlbedo albedo;
    const std::size_t strata = 1 + *std::max_element(pairs.stratum.begin(), pairs.stratum.end());
    for (std::size_t s = 0; s < strata; ++s) {
        albedo.first.push_back(albedo.points.size());
        albedo.targets.resize((s + 1) * channels, 0.0);
        double share = 0;
        for (std::size_t g = 0; g < pairs.wo.size(); ++g) {
            if (pairs.stratum[g] != s) continue;
            const Direction& wo = pairs.wo[g];
            for (std::size_t k = pairs.first[g]; k < pairs.first[g + 1]; ++k) {
                const Direction wi{pairs.x[k], pairs.y[k], pairs.z[k]};
                std::vector<double> back(channels);
                if (reciprocal) brdf.eval(wi, {&wo.x, &wo.y, &wo.z, 1}, back.data());
                const double weight = 2 * pi * pairs.weights[k] * wi.z;
                share += pairs.weights[k];
                for (std::size_t c = 0; c < channels; ++c) {
                    const double there = std::max(0.0, values[c * pairs.size() + k]);
                    const double f = reciprocal ? (there + std::max(0.0, back[c])) / 2 : there;
                    albedo.targets[s * channels + c] += weight * f;
                }
                albedo.points.push_back(halfwayPoint(wi, wo));
                albedo.places.push_back(envelopePoint(wi, wo));
                albedo.weights.push_back(weight);
            }
        }
        for (std::size_t k = albedo.first[s]; k < albedo.weights.size(); ++k) {
            albedo.weights[k] /= share;
        }
        for (std::size_t c = 0; c < channels; ++c) albedo.targets[s * channels + c] /= share;
        albedo.shares.push_back(share);
    }
    albedo.first.push_back(albedo.points.size());
    return albedo;
}

std::vector<double> expansionAt(const HalfwayTerms& terms, const HalfwayAlbedo& albedo,
                                const HalfwayValues& values) {
    const std::size_t channels = albedo.channels();
    std::vector<double> f(albedo.points.size() * channels);
    tbb::parallel_for(std::size_t{0}, albedo.strata(), [&](std::size_t s) {
        Eigen::VectorXd products(values.rows());
        for (std::size_t k = albedo.first[s]; k < albedo.first[s + 1]; ++k) {
            terms.evaluate(albedo.points[k], products.data());
            for (std::size_t c = 0; c < channels; ++c) {
                const double y = products.dot(values.col(static_cast<Eigen::Index>(c)));
                f[k * channels + c] = std::max(0.0, std::expm1(std::min(y, greatestExponent)));
            }
        }
    });
    return f;
}

std::vector<double> albedoOf(const HalfwayAlbedo& albedo, const std::vector<double>& f,
                             const std::vector<double>& caps) {
    const std::size_t channels = albedo.channels();
    std::vector<double> sums(albedo.targets.size(), 0.0);
    for (std::size_t s = 0; s < albedo.strata(); ++s) {
        for (std::size_t at = albedo.first[s] * channels; at < albedo.first[s + 1] * channels;
             ++at) {
            const double value = caps.empty() ? f[at] : std::min(f[at], std::exp(caps[at]));
            sums[s * channels + at % channels] += albedo.weights[at / channels] * value;
        }
    }
    return sums;
}

double addAlbedo(const HalfwayTerms& terms, const HalfwayAlbedo& albedo,
                 const std::vector<double>& caps, const HalfwayValues& values, double weight,
                 std::vector<HalfwaySystem>& systems) {
    const std::size_t channels = albedo.channels();
    std::vector<double> sums(albedo.targets.size(), 0.0);
    std::vector<HalfwayValues> slopes(albedo.strata());
    tbb::parallel_for(std::size_t{0}, albedo.strata(), [&](std::size_t s) {
        slopes[s] = HalfwayValues::Zero(values.rows(), values.cols());
        sumStratum(terms, albedo, caps, values, s, sums.data() + s * channels, slopes[s]);
    });
    double mean = 0;
    for (std::size_t s = 0; s < albedo.strata(); ++s) {
        for (std::size_t c = 0; c < channels; ++c) {
            const double target = albedo.targets[s * channels + c];
            if (!(target > 0)) continue;
            const double now = sums[s * channels + c], relative = now / target - 1;
            mean += albedo.shares[s] * relative * relative / static_cast<double>(channels);
            const auto column = slopes[s].col(static_cast<Eigen::Index>(c));
            const double share = weight * albedo.shares[s] / (target * target);
            const double wanted =
                target - now + column.dot(values.col(static_cast<Eigen::Index>(c)));
            systems[c].gram.noalias() += share * column * column.transpose();
            systems[c].right += share * wanted * column;
        }
    }
    return mean;
}

HalfwayFit heldToAlbedo(const HalfwayTerms& terms, const HalfwaySamples& samples,
                        const HalfwayAlbedo& albedo, const std::vector<double>& caps,
                        HalfwayFit fit) {
    constexpr int mostSteps = 10, mostHalvings = 5;
    constexpr double settled = 0.01, shortened = 0.4;
    const double weight = 50 * fit.loss;
    double least = std::numeric_limits<double>::infinity();
    HalfwayValues next = fit.values, best = fit.values;
    int halvings = 0;
    for (int step = 0; weight > 0 && step <= mostSteps; ++step) {
        HalfwayPass pass = halfwayPass(terms, samples, next);
        // By the loss alone: the albedo's part of the diagonal is far larger.
        for (HalfwaySystem& system : pass.systems) {
            system.gram.diagonal().array() += fit.regularisation * system.gram.diagonal().mean();
        }
        const double off = addAlbedo(terms, albedo, caps, next, weight, pass.systems);
        if (step == 0 && off < rightEnough) return fit;
        const double sum = pass.loss + weight * off;
        if (!(sum < least) && halvings < mostHalvings) {
            ++halvings;
            next = best + shortened * (next - best);
            continue;
        }
        const bool done = !(sum < least * (1 - settled));
        if (sum < least) {
            least = sum;
            best = next;
            fit.loss = pass.loss;
        }
        if (done) break;
        next = solveHalfway(pass.systems, 0);
    }
    fit.values = std::move(best);
    return fit;
}

}  // namespace hshfit::inline representation::inline halfway
