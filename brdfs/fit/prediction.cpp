#include <brdfs/fit/prediction.h>

#include <brdfs/fit/distributions.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>
#include <brdfs/fit/percentiles.h>
#include <brdfs/fit/scan_spread.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/stop_request.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace hshfit::brdfs {
namespace {

/// Pairs are taken so many at a time, to bound the memory of derivatives and of draws.
constexpr std::size_t atOnce = 4096;
constexpr double unlimited = std::numeric_limits<double>::infinity();

/// x of FitProblem::joint from values of the parameters.
std::vector<double> pointOf(const ParametricSum& sum, const std::vector<double>& values) {
    std::vector<double> x = values;
    for (std::size_t j = 0; j < sum.shapes().size(); ++j) x[j] = sum.shapes()[j].toScale(values[j]);
    return x;
}

/// Derivatives of f by the coefficients at pairs of one channel.
struct Gradients {
    std::vector<std::size_t> coefficients;  ///< on which the channel depends
    Eigen::MatrixXd slopes;                 ///< [pair, coefficient of these]
    std::vector<double> values;             ///< f
};

Gradients gradientsOf(const FittedChannel& channel, const FitSamples& samples) {
    const ParametricSum sum(channel.model, samples.isotropic, channel.channel, channel.coloured);
    const FitProblem problem(samples, sum, Loss::Kind::l2);
    const WeightedRows rows = problem.weightedRows(pointOf(sum, channel.values));
    Gradients result;
    for (const auto& slopes : channel.slopes)
        for (const FittedChannel::Slope& own : slopes)
            result.coefficients.push_back(own.coefficient);
    std::ranges::sort(result.coefficients);
    result.coefficients.erase(std::unique(result.coefficients.begin(), result.coefficients.end()),
                              result.coefficients.end());
    Eigen::MatrixXd byCoefficient =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.columns),
                              static_cast<Eigen::Index>(result.coefficients.size()));
    for (std::size_t i = 0; i < rows.columns; ++i) {
        // Rows hold derivatives by x, of which shapes are functions.
        const double byX = i < sum.shapes().size() ? sum.shapes()[i].slope(channel.values[i]) : 1.0;
        for (const FittedChannel::Slope& own : channel.slopes[i]) {
            const auto at = std::ranges::lower_bound(result.coefficients, own.coefficient);
            byCoefficient(static_cast<Eigen::Index>(i), at - result.coefficients.begin()) +=
                own.slope / byX;
        }
    }
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Rows> slopes(rows.slopes.data(),
                                        static_cast<Eigen::Index>(samples.size()),
                                        static_cast<Eigen::Index>(rows.columns));
    result.slopes = slopes * byCoefficient;
    result.values = rows.values;
    return result;
}

Eigen::MatrixXd partOf(const std::vector<double>& covariance,
                       const std::vector<std::size_t>& coefficients) {
    const auto n = static_cast<std::size_t>(std::llround(std::sqrt(covariance.size())));
    const auto size = static_cast<Eigen::Index>(coefficients.size());
    Eigen::MatrixXd part(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
        for (Eigen::Index j = 0; j < size; ++j)
            part(i, j) = covariance[coefficients[static_cast<std::size_t>(i)] * n +
                                    coefficients[static_cast<std::size_t>(j)]];
    return part;
}

/// Degrees of freedom of the variances of f without what is common to all samples.
std::vector<double> degreesOfSamples(const FittedPoint& point, const Gradients& g) {
    for (const FittedPoint::Freedom& part : point.freedom) {
        const Eigen::Index count = part.of->count();
        Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(g.slopes.rows(), count);
        bool own = true;
        for (std::size_t i = 0; own && i < g.coefficients.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(g.coefficients[i]) -
                            static_cast<Eigen::Index>(part.first);
            own = at >= 0 && at < count;
            if (own) whole.col(at) = g.slopes.col(static_cast<Eigen::Index>(i));
        }
        if (!own) continue;
        std::vector<double> degrees = part.of->degrees(whole);
        for (double& d : degrees) d = d > 0 ? std::max(d, 1.0) : unlimited;
        return degrees;
    }
    return std::vector<double>(static_cast<std::size_t>(g.slopes.rows()), unlimited);
}

/// Degrees of freedom of the variances of f (Welch-Satterthwaite).
std::vector<double> degreesOf(const FittedPoint& point, const Gradients& g,
                              const Eigen::VectorXd& variance) {
    std::vector<double> degrees = degreesOfSamples(point, g);
    if (point.common.empty()) return degrees;
    Eigen::VectorXd own = variance, fourths = Eigen::VectorXd::Zero(variance.size());
    for (const FittedPoint::Common& common : point.common) {
        Eigen::VectorXd change(static_cast<Eigen::Index>(g.coefficients.size()));
        for (std::size_t i = 0; i < g.coefficients.size(); ++i)
            change(static_cast<Eigen::Index>(i)) = common.change[g.coefficients[i]];
        const Eigen::VectorXd part = (g.slopes * change).cwiseAbs2();
        own -= part;
        fourths += part.cwiseAbs2() / common.degrees;
    }
    for (Eigen::Index k = 0; k < variance.size(); ++k) {
        double& d = degrees[static_cast<std::size_t>(k)];
        const double sum = fourths(k) + own(k) * own(k) / d;
        d = sum > 0 ? std::max(1.0, variance(k) * variance(k) / sum) : unlimited;
    }
    return degrees;
}

void addBootstrapBands(const FitResult& fit, const FitSamples& samples, std::size_t first,
                       Prediction& result) {
    Prediction::Bootstrap& bands = *result.bootstrap;
    std::vector<std::vector<double>> f;
    for (std::size_t c = 0; c < result.channels; ++c) {
        const FittedChannel& channel = fit.point.channels[c];
        const ParametricSum sum(channel.model, samples.isotropic, channel.channel,
                                channel.coloured);
        const FitProblem problem(samples, sum, Loss::Kind::l2);
        f.clear();
        for (const auto& draw : fit.point.draws)
            if (!draw.empty()) f.push_back(problem.values(pointOf(sum, draw[c])));
        eachInParallel(samples.size(), [&](std::size_t k) {
            std::vector<double> values;
            for (const std::vector<double>& own : f) values.push_back(own[k]);
            const ParameterUncertainty::Bootstrap summary = summarised(std::move(values));
            const std::size_t v = c * result.pairs + first + k;
            bands.errors[v] = summary.error;
            bands.within68[v] = summary.within68;
            bands.within95[v] = summary.within95;
        });
    }
}

std::size_t drawsOf(const FitResult& fit) {
    return static_cast<std::size_t>(
        std::ranges::count_if(fit.point.draws, [](const auto& draw) { return !draw.empty(); }));
}

}  // namespace

double Prediction::pointwise(double probability, double degrees) {
    return studentBound(1 - probability, degrees);
}

double Prediction::widest(double probability) const {
    return pointwise(probability, degrees.empty() ? unlimited : std::ranges::min(degrees));
}

Prediction predict(const FitResult& fit, std::span<const DirectionPair> pairs, bool bootstrap) {
    Prediction result;
    result.pairs = pairs.size();
    result.channels = fit.point.channels.size();
    const std::size_t count = result.pairs * result.channels;
    result.values.resize(count);
    result.errors.resize(count);
    result.degrees.resize(count);
    if (bootstrap && drawsOf(fit) > 1)
        result.bootstrap = {std::vector<double>(count), std::vector<Interval>(count),
                            std::vector<Interval>(count)};
    for (std::size_t first = 0; first < pairs.size(); first += atOnce) {
        stopIfRequested();
        const FitSamples samples =
            unmeasuredSamples(pairs.subspan(first, std::min(atOnce, pairs.size() - first)),
                              Channels(), fit.point.isotropic);
        for (std::size_t c = 0; c < result.channels; ++c) {
            const Gradients g = gradientsOf(fit.point.channels[c], samples);
            const Eigen::MatrixXd covariance = partOf(fit.point.covariance, g.coefficients);
            const Eigen::VectorXd variance =
                (g.slopes * covariance).cwiseProduct(g.slopes).rowwise().sum();
            const std::vector<double> degrees = degreesOf(fit.point, g, variance);
            for (std::size_t k = 0; k < samples.size(); ++k) {
                const std::size_t v = c * result.pairs + first + k;
                result.values[v] = g.values[k];
                result.degrees[v] = degrees[k];
                result.errors[v] = std::sqrt(std::max(0.0, variance(static_cast<Eigen::Index>(k))));
            }
        }
        if (result.bootstrap) addBootstrapBands(fit, samples, first, result);
    }
    return result;
}

Prediction predict(const FitResult& fit, const FitSamples& samples, bool bootstrap) {
    if (samples.sums)
        throw UsageError("predictions are those of f at pairs of directions, not of its sums");
    std::vector<DirectionPair> pairs;
    for (std::size_t k = 0; k < samples.size(); ++k)
        pairs.push_back({{samples.wiX[k], samples.wiY[k], samples.wiZ[k]}, samples.wo[k]});
    return predict(fit, pairs, bootstrap);
}

double simultaneousFactor(const FitResult& fit, std::span<const DirectionPair> pairs,
                          double probability, std::uint64_t seed, std::size_t draws) {
    const auto n = static_cast<Eigen::Index>(std::llround(std::sqrt(fit.point.covariance.size())));
    const Eigen::Map<const Eigen::MatrixXd> covariance(fit.point.covariance.data(), n, n);
    // As correlations, so that coefficients of any unit keep their digits.
    Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0).cwiseSqrt();
    Eigen::VectorXd inverse = scale;
    for (double& s : inverse) s = s > 0 ? 1 / s : 0;
    const Eigen::MatrixXd correlations = inverse.asDiagonal() * covariance * inverse.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlations);
    const Eigen::MatrixXd root = scale.asDiagonal() * eigen.eigenvectors() *
                                 eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
    Eigen::MatrixXd normal(n, static_cast<Eigen::Index>(draws));
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (double& z : normal.reshaped())
        z = std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform());
    const Eigen::MatrixXd changes = root * normal;
    Eigen::VectorXd most = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(draws));
    constexpr std::size_t few = 256;
    double degrees = unlimited;
    for (std::size_t first = 0; first < pairs.size(); first += few) {
        stopIfRequested();
        const FitSamples samples =
            unmeasuredSamples(pairs.subspan(first, std::min(few, pairs.size() - first)), Channels(),
                              fit.point.isotropic);
        for (const FittedChannel& channel : fit.point.channels) {
            const Gradients g = gradientsOf(channel, samples);
            const Eigen::MatrixXd own = partOf(fit.point.covariance, g.coefficients);
            const Eigen::VectorXd variance =
                (g.slopes * own).cwiseProduct(g.slopes).rowwise().sum();
            Eigen::VectorXd error = variance.cwiseMax(0).cwiseSqrt();
            for (double& e : error) e = e > 0 ? 1 / e : 0;
            std::vector<Eigen::Index> rows(g.coefficients.begin(), g.coefficients.end());
            degrees = std::min(degrees, std::ranges::min(degreesOf(fit.point, g, variance)));
            const Eigen::MatrixXd z = error.asDiagonal() * g.slopes * changes(rows, Eigen::all);
            most = most.cwiseMax(z.cwiseAbs().colwise().maxCoeff().transpose());
        }
    }
    if (std::isfinite(degrees))
        for (double& z : most) z *= std::sqrt(degrees / chiSquareQuantile(uniform(), degrees));
    std::vector<double> sorted(most.begin(), most.end());
    std::ranges::sort(sorted);
    // The quantile of one pair but for the chance of the draws, where one combination decides all.
    return std::max(percentile(sorted, probability), Prediction::pointwise(probability, degrees));
}

}  // namespace hshfit::brdfs
