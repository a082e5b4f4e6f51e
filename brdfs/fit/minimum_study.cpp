#include <brdfs/fit/minimum_study.h>

#include <brdfs/fit/distributions.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

using DenseMatrix = Eigen::MatrixXd;
using DenseVector = Eigen::VectorXd;

/// Rounding leaves some of 1 - leverage where a value, or a scan, alone decides.
constexpr double leastFreedom = 1e-6;

Eigen::Index at(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

/// (J^T W J)^-1 from the inverse of the normalised matrix.
DenseMatrix unscaledInverse(const FitProblem& problem, std::span<const double> inverse,
                            std::size_t n) {
    return Eigen::Map<const DenseMatrix>(inverse.data(), at(n), at(n)) / problem.normalisation();
}

/// The part of a matrix over all parameters that acts on one channel.
DenseMatrix channelPart(const DenseMatrix& whole, const WeightedRows& rows, std::size_t channel,
                        std::size_t shapes) {
    std::vector<Eigen::Index> places;
    for (std::size_t i = 0; i < rows.columns; ++i)
        places.push_back(at(rows.place(i, channel, shapes)));
    return whole(places, places);
}

std::vector<double> leveragesOf(const WeightedRows& rows, const DenseMatrix& inverse,
                                std::size_t shapes) {
    std::vector<double> leverages(rows.residuals.size());
    for (std::size_t c = 0; c < rows.channels; ++c) {
        const DenseMatrix own = channelPart(inverse, rows, c, shapes);
        for (std::size_t k = 0; k < rows.samples; ++k) {
            const std::size_t value = c * rows.samples + k;
            const Eigen::Map<const DenseVector> slopes(rows.slopes.data() + value * rows.columns,
                                                       at(rows.columns));
            leverages[value] = slopes.dot(own * slopes);
        }
    }
    return leverages;
}

/// J^T W J and J^T W r of the values of one scan.
struct ScanSums {
    DenseMatrix matrix;
    DenseVector gradient;
};

std::vector<ScanSums> sumsOfScans(const WeightedRows& rows, const std::vector<std::size_t>& scans,
                                  std::size_t n, std::size_t shapes) {
    const std::size_t count = *std::ranges::max_element(scans) + 1;
    std::vector<ScanSums> sums(count, {DenseMatrix::Zero(at(n), at(n)), DenseVector::Zero(at(n))});
    for (std::size_t c = 0; c < rows.channels; ++c)
        for (std::size_t k = 0; k < rows.samples; ++k) {
            const std::size_t value = c * rows.samples + k;
            const double* slopes = rows.slopes.data() + value * rows.columns;
            ScanSums& scan = sums[scans[k]];
            for (std::size_t i = 0; i < rows.columns; ++i) {
                const Eigen::Index row = at(rows.place(i, c, shapes));
                scan.gradient(row) += slopes[i] * rows.residuals[value];
                for (std::size_t j = 0; j < rows.columns; ++j)
                    scan.matrix(row, at(rows.place(j, c, shapes))) += slopes[i] * slopes[j];
            }
        }
    return sums;
}

/// L with L L^T = inverse, from the eigenvalues of the matrix scaled to a diagonal of 1.
DenseMatrix rootOf(const DenseMatrix& inverse) {
    DenseVector scale = inverse.diagonal().cwiseMax(0).cwiseSqrt();
    DenseMatrix scaled = inverse;
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
        const double s = scale(i) > 0 ? 1 / scale(i) : 0;
        scaled.row(i) *= s, scaled.col(i) *= s;
    }
    const Eigen::SelfAdjointEigenSolver<DenseMatrix> eigen(scaled);
    return scale.asDiagonal() * eigen.eigenvectors() *
           eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

std::size_t scanCount(const FitSamples& samples) {
    return samples.scans.empty() ? 0 : *std::ranges::max_element(samples.scans) + 1;
}

}  // namespace

std::vector<double> spreadOfScans(const FitProblem& problem, std::span<const double> x,
                                  std::span<const double> inverse) {
    const std::vector<std::size_t>& scans = problem.samples().scans;
    const std::size_t n = x.size(), shapes = problem.shapeCount();
    const WeightedRows rows = problem.weightedRows(x);
    const DenseMatrix root = rootOf(unscaledInverse(problem, inverse, n));
    const std::vector<ScanSums> sums = sumsOfScans(rows, scans, n, shapes);
    if (sums.size() <= rows.columns)
        throw NumericError(fmt::format(
            "{} scans cannot give errors of {} parameters; expected more scans than parameters",
            sums.size(), rows.columns));
    // With M = L L^T: (1 - A M)^-1 b = b + A L (1 - L^T A L)^-1 L^T b.
    DenseMatrix spread = DenseMatrix::Zero(at(n), at(n));
    for (const ScanSums& scan : sums) {
        const DenseMatrix own = root.transpose() * scan.matrix * root;
        const Eigen::SelfAdjointEigenSolver<DenseMatrix> eigen(own);
        const DenseVector freedom = (1 - eigen.eigenvalues().array()).max(leastFreedom);
        const DenseVector inner =
            eigen.eigenvectors() * freedom.cwiseInverse().asDiagonal() *
            (eigen.eigenvectors().transpose() * (root.transpose() * scan.gradient));
        const DenseVector left = scan.gradient + scan.matrix * (root * inner);
        spread += left * left.transpose();
    }
    const double count = static_cast<double>(sums.size());
    spread *= (count - 1) / (count * problem.normalisation() * problem.normalisation());
    return {spread.data(), spread.data() + n * n};
}

Uncertainty studied(const StudiedMinimum& minimum) {
    const FitProblem& problem = minimum.problem;
    const std::size_t n = minimum.x.size(), shapes = problem.shapeCount();
    const WeightedRows rows = problem.weightedRows(minimum.x);
    const DenseMatrix inverse =
        unscaledInverse(problem, inverseOf(minimum.equations, minimum.fixed), n);
    const std::vector<double> leverages = leveragesOf(rows, inverse, shapes);
    Uncertainty result;
    result.stated = !problem.samples().sigmas.empty();
    result.scans = scanCount(problem.samples());
    double rank = 0;
    for (std::size_t v = 0; v < leverages.size(); ++v) {
        rank += leverages[v];
        result.chiSquare += rows.residuals[v] * rows.residuals[v];
    }
    const double count = static_cast<double>(leverages.size()), determined = std::round(rank);
    const double degrees = std::max(0.0, count - determined);
    result.degreesOfFreedom = static_cast<std::size_t>(degrees);
    if (result.stated) result.probability = chiSquareProbability(result.chiSquare, degrees);
    const double variance = result.reducedChiSquare();

    result.values.resize(leverages.size());
    for (std::size_t v = 0; v < leverages.size(); ++v) {
        const double freedom = std::max(1 - leverages[v], leastFreedom);
        const double own = rows.residuals[v] * rows.residuals[v] / freedom;
        ValueInfluence& value = result.values[v];
        value.model = rows.values[v];
        value.leverage = leverages[v];
        if (variance > 0 && determined > 0)
            value.cook = own * leverages[v] / (freedom * determined * variance);
        const double others = (result.chiSquare - own) / (degrees - 1);
        if (degrees > 1 && others > 0)
            value.studentised = rows.residuals[v] / std::sqrt(others * freedom);
    }
    constexpr double expected = 0.05;
    if (degrees > 1) result.outlierBound = studentBound(expected / count, degrees - 1);

    const double scale = result.stated ? 1 : variance;
    result.parameters.resize(n);
    result.covariance.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (minimum.stated.variance[i] < 0) continue;
        ParameterUncertainty& own = result.parameters[i];
        for (std::size_t j = 0; j < n; ++j)
            if (minimum.stated.variance[j] >= 0)
                result.covariance[i * n + j] =
                    scale * inverse(at(i), at(j)) * minimum.slope[i] * minimum.slope[j];
        own.normal = std::sqrt(result.covariance[i * n + i]);
        if (minimum.sandwich.variance[i] >= 0)
            own.sandwich = std::sqrt(minimum.sandwich.variance[i]) * minimum.slope[i];
        if (result.scans > 0) own.scans = std::sqrt(minimum.stated.variance[i]) * minimum.slope[i];
    }
    return result;
}

}  // namespace hshfit::brdfs
