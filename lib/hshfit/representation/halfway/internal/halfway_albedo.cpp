#include <hshfit/representation/halfway/internal/halfway_albedo.h>

#include <hshfit/accuracy/pair_sample.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr int outgoingStrata = 12;
/// Directions wo in a stratum, and pairs of each. With one alone the form has the right albedo at
/// it, and swings between the strata.
constexpr int elevations = 8, isotropicPairs = 256;
constexpr int azimuths = 6, anisotropicPairs = 512;
constexpr double albedoWeight = 10;
/// The cosine of theta_o at 85 degrees. Directions beyond it do not count: the values that measured
/// files have there would rule the rest.
constexpr double leastCosine = 0.0872;

/// Albedo of one stratum and its derivatives by the coefficients, [term][channel].
void sumStratum(const HalfwayModel& model, const HalfwayAlbedo& albedo, const HalfwayValues& values,
                std::size_t stratum, double* sums, HalfwayValues& slopes) {
    const auto smooth = static_cast<Eigen::Index>(model.terms.smooth());
    const Eigen::Index rest = values.rows() - smooth;
    Eigen::VectorXd products(values.rows());
    for (std::size_t k = albedo.first[stratum]; k < albedo.first[stratum + 1]; ++k) {
        const HalfwayPoint point = model.axes.at(albedo.pairs[k].wi, albedo.pairs[k].wo);
        model.terms.evaluate(point, products.data());
        for (Eigen::Index c = 0; c < values.cols(); ++c) {
            const auto exponential = [&](Eigen::Index first, Eigen::Index count) {
                const double sum =
                    products.segment(first, count).dot(values.col(c).segment(first, count));
                return std::exp(std::min(sum, greatestExponent));
            };
            const double a = albedo.weights[k] * exponential(0, smooth);
            const double b = albedo.weights[k] * point.weight * exponential(smooth, rest);
            sums[c] += a + b;
            slopes.col(c).head(smooth) += a * products.head(smooth);
            slopes.col(c).tail(rest) += b * products.tail(rest);
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
    const bool isotropic = brdf.laws().isotropic;
    const PairSample pairs =
        spreadPairs({.replicates = isotropic ? elevations : azimuths,
                     .outgoing = outgoingStrata,
                     .incoming = isotropic ? isotropicPairs : anisotropicPairs});
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values = evaluateOn(brdf, pairs);
    HalfwayAlbedo albedo;
    const std::size_t strata = 1 + *std::max_element(pairs.stratum.begin(), pairs.stratum.end());
    for (std::size_t s = 0; s < strata; ++s) {
        albedo.first.push_back(albedo.pairs.size());
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
                albedo.pairs.push_back({wi, wo});
                albedo.weights.push_back(weight);
            }
        }
        for (std::size_t k = albedo.first[s]; k < albedo.weights.size(); ++k) {
            albedo.weights[k] /= share;
        }
        for (std::size_t c = 0; c < channels; ++c) albedo.targets[s * channels + c] /= share;
        albedo.shares.push_back(share);
    }
    albedo.first.push_back(albedo.pairs.size());
    return albedo;
}

HalfwayAlbedoErrors::HalfwayAlbedoErrors(const HalfwayModel& model, const HalfwayAlbedo& albedo,
                                         const HalfwayValues& values)
    : albedo_(albedo), sums_(albedo.targets.size(), 0.0), slopes_(albedo.strata()) {
    const std::size_t channels = albedo.channels();
    tbb::parallel_for(std::size_t{0}, albedo.strata(), [&](std::size_t s) {
        slopes_[s] = HalfwayValues::Zero(values.rows(), values.cols());
        sumStratum(model, albedo, values, s, sums_.data() + s * channels, slopes_[s]);
    });
}

template <class Add>
void HalfwayAlbedoErrors::forEachStratum(std::size_t channel, const Add& add) const {
    for (std::size_t s = 0; s < albedo_.strata(); ++s) {
        if (albedo_.pairs[albedo_.first[s]].wo.z < leastCosine) continue;
        const std::size_t place = s * albedo_.channels() + channel;
        const double target = albedo_.targets[place];
        if (target > 0) add(sums_[place] / target - 1, albedoWeight * albedo_.shares[s], s, target);
    }
}

double HalfwayAlbedoErrors::loss(std::size_t channel) const {
    double sum = 0;
    forEachStratum(channel, [&](double relative, double weight, std::size_t, double) {
        sum += weight * relative * relative / 2;
    });
    return sum;
}

void HalfwayAlbedoErrors::addTo(std::size_t channel, HalfwaySystem& system) const {
    forEachStratum(channel, [&](double relative, double weight, std::size_t s, double target) {
        const Eigen::VectorXd column = slopes_[s].col(static_cast<Eigen::Index>(channel)) / target;
        system.gram.noalias() += weight * column * column.transpose();
        system.slope += weight * relative * column;
    });
}

}  // namespace hshfit::inline representation::inline halfway
