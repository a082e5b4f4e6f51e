#include <brdfs/fit/minimum_study.h>

#include <brdfs/fit/dense.h>
#include <brdfs/fit/distributions.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

/// (J^T W J)^-1 from the inverse of the normalised matrix.
Matrix unscaledInverse(const FitProblem& problem, std::span<const double> inverse, std::size_t n) {
    return squareMatrix(inverse, n) / problem.normalisation();
}

/// The part of a matrix over all parameters that acts on one channel.
Matrix channelPart(const Matrix& whole, const WeightedRows& rows, std::size_t channel,
                   std::size_t shapes) {
    std::vector<Eigen::Index> places;
    for (std::size_t i = 0; i < rows.columns; ++i)
        places.push_back(at(rows.place(i, channel, shapes)));
    return whole(places, places);
}

Matrix wholeRows(const WeightedRows& rows, std::size_t n, std::size_t shapes) {
    Matrix whole = Matrix::Zero(at(rows.channels * rows.samples), at(n));
    for (std::size_t c = 0; c < rows.channels; ++c)
        for (std::size_t k = 0; k < rows.samples; ++k) {
            const std::size_t value = c * rows.samples + k;
            for (std::size_t i = 0; i < rows.columns; ++i)
                whole(at(value), at(rows.place(i, c, shapes))) =
                    rows.slopes[value * rows.columns + i];
        }
    return whole;
}

std::size_t parametersOfChannel(const FitProblem& problem) {
    return problem.shapeCount() + problem.sum().linears().size();
}

std::size_t scanCount(const FitSamples& samples) {
    return samples.scans.empty() || samples.correlation.any()
               ? 0
               : *std::ranges::max_element(samples.scans) + 1;
}

}  // namespace

std::vector<double> leveragesOf(const WeightedRows& rows, const Matrix& inverse,
                                std::size_t shapes) {
    std::vector<double> leverages(rows.residuals.size());
    for (std::size_t c = 0; c < rows.channels; ++c) {
        const Matrix own = channelPart(inverse, rows, c, shapes);
        for (std::size_t k = 0; k < rows.samples; ++k) {
            const std::size_t value = c * rows.samples + k;
            const Eigen::Map<const Vector> slopes(rows.slopes.data() + value * rows.columns,
                                                  at(rows.columns));
            leverages[value] = slopes.dot(own * slopes);
        }
    }
    return leverages;
}

std::vector<ScanSums> sumsOfScans(const WeightedRows& rows, const std::vector<std::size_t>& scans,
                                  std::size_t n, std::size_t shapes) {
    const std::size_t count = *std::ranges::max_element(scans) + 1;
    std::vector<ScanSums> sums(count, {Matrix::Zero(at(n), at(n)), Vector::Zero(at(n))});
    for (std::size_t c = 0; c < rows.channels; ++c)
        for (std::size_t k = 0; k < rows.samples; ++k) {
            const std::size_t value = c * rows.samples + k;
            const double* slopes = rows.slopes.data() + value * rows.columns;
            ScanSums& scan = sums[scans[k % scans.size()]];
            for (std::size_t i = 0; i < rows.columns; ++i) {
                const Eigen::Index row = at(rows.place(i, c, shapes));
                scan.gradient(row) += slopes[i] * rows.residuals[value];
                for (std::size_t j = 0; j < rows.columns; ++j)
                    scan.matrix(row, at(rows.place(j, c, shapes))) += slopes[i] * slopes[j];
            }
        }
    return sums;
}

std::shared_ptr<const VarianceFreedom> freedomAt(const FitProblem& problem,
                                                 std::span<const double> x,
                                                 std::span<const double> inverse,
                                                 const std::vector<double>& slope) {
    const FitSamples& samples = problem.samples();
    const bool byScan = !samples.scans.empty();
    if (!byScan && (samples.sums || samples.size() * problem.channels() > mostFreedomValues))
        return {};
    const std::size_t n = x.size(), shapes = problem.shapeCount();
    const WeightedRows rows = problem.weightedRows(x);
    Matrix own = unscaledInverse(problem, inverse, n);
    Vector slopes = Eigen::Map<const Vector>(slope.data(), at(n));
    if (!byScan)
        return std::make_shared<const VarianceFreedom>(wholeRows(rows, n, shapes), std::move(own),
                                                       std::move(slopes));
    return std::make_shared<const VarianceFreedom>(sumsOfScans(rows, samples.scans, n, shapes),
                                                   std::move(own), std::move(slopes));
}

bool scansSuffice(const FitProblem& problem, const VarianceFreedom& byScan) {
    return byScan.scanCount() > parametersOfChannel(problem);
}

std::vector<double> spreadOfScans(const FitProblem& problem, const VarianceFreedom& byScan,
                                  const Equations& equations) {
    const double norm = problem.normalisation();
    if (!scansSuffice(problem, byScan)) {
        requireScans(byScan.scanCount(), parametersOfChannel(problem),
                     !problem.samples().sigmas.empty());
        std::vector<double> spread = equations.hessian;
        for (double& value : spread) value /= norm;
        return spread;
    }
    const Matrix spread = byScan.spread() / (norm * norm);
    return {spread.data(), spread.data() + spread.size()};
}

Uncertainty influences(const StudiedValues& values) {
    Uncertainty result;
    result.stated = values.stated;
    result.correlated = values.correlated;
    result.whitened = values.whitened;
    result.scans = values.scans;
    result.scanParameters = values.scanParameters;
    double rank = values.otherRank;
    result.chiSquare = values.otherSquares;
    for (std::size_t v = 0; v < values.leverages.size(); ++v) {
        rank += values.leverages[v];
        result.chiSquare += values.residuals[v] * values.residuals[v];
    }
    const double count = static_cast<double>(values.leverages.size()),
                 determined = std::round(rank);
    const double degrees = std::max(0.0, count + values.otherCount - determined);
    result.degreesOfFreedom = static_cast<std::size_t>(degrees);
    if (result.stated && (result.whitened || !result.correlated))
        result.probability = chiSquareProbability(result.chiSquare, degrees);
    const double variance = result.reducedChiSquare();

    result.values.resize(values.leverages.size());
    for (std::size_t v = 0; v < values.leverages.size(); ++v) {
        const double leverage = values.leverages[v], residual = values.residuals[v];
        const double freedom = std::max(1 - leverage, leastFreedom);
        const double own = residual * residual / freedom;
        ValueInfluence& value = result.values[v];
        value.model = values.models[v];
        value.leverage = leverage;
        if (variance > 0 && determined > 0)
            value.cook = own * leverage / (freedom * determined * variance);
        const double others = (result.chiSquare - own) / (degrees - 1);
        if (degrees > 1 && others > 0) value.studentised = residual / std::sqrt(others * freedom);
    }
    constexpr double expected = 0.05;
    if (degrees > 1) result.outlierBound = studentBound(expected / count, degrees - 1);
    return result;
}

void addErrors(std::span<const double> inverse, const std::vector<double>& slope,
               const Covariance& stated, const Covariance& sandwich,
               const std::vector<double>& scanDegrees, Uncertainty& result) {
    const std::size_t n = slope.size();
    const double scale = result.stated ? 1 : result.reducedChiSquare();
    result.parameters.resize(n);
    result.covariance.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (stated.variance[i] < 0) continue;
        ParameterUncertainty& own = result.parameters[i];
        for (std::size_t j = 0; j < n; ++j)
            if (stated.variance[j] >= 0)
                result.covariance[i * n + j] = scale * inverse[i * n + j] * slope[i] * slope[j];
        own.normal = std::sqrt(result.covariance[i * n + i]);
        if (sandwich.variance[i] >= 0) own.sandwich = std::sqrt(sandwich.variance[i]) * slope[i];
        if (result.correlated) own.correlated = std::sqrt(stated.variance[i]) * slope[i];
        if (!result.scansSuffice()) continue;
        own.scans = std::sqrt(stated.variance[i]) * slope[i];
        if (i < scanDegrees.size() && scanDegrees[i] > 0) own.scanDegrees = scanDegrees[i];
    }
}

Uncertainty studied(const StudiedMinimum& minimum) {
    const FitProblem& problem = minimum.problem;
    const std::size_t n = minimum.x.size(), shapes = problem.shapeCount();
    const WeightedRows rows = problem.weightedRows(minimum.x);
    const Matrix inverse = unscaledInverse(problem, inverseOf(minimum.equations, minimum.fixed), n);
    Uncertainty result = influences({.residuals = rows.residuals,
                                     .models = rows.values,
                                     .leverages = leveragesOf(rows, inverse, shapes),
                                     .stated = !problem.samples().sigmas.empty(),
                                     .correlated = problem.samples().correlation.any(),
                                     .whitened = rows.whitened,
                                     .scans = scanCount(problem.samples()),
                                     .scanParameters = parametersOfChannel(problem)});
    std::vector<double> degrees;
    if (result.scansSuffice()) degrees = minimum.freedom->degrees(Matrix::Identity(at(n), at(n)));
    addErrors({inverse.data(), n * n}, minimum.slope, minimum.stated, minimum.sandwich, degrees,
              result);
    return result;
}

}  // namespace hshfit::brdfs
