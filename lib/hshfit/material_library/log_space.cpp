#include <hshfit/material_library/log_space.h>

#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/pictures/picture_error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace hshfit::material_library {
namespace {

constexpr unsigned fittedSeed = 2;     ///< of the pairs; the pairs that measure errors have seed 1
constexpr int fittedIncoming = 200;    ///< pairs of one outgoing direction
constexpr double byPair = 0.5;         ///< share of the weight that counts pairs
constexpr double ridge = 1e-8;         ///< of the mean diagonal: the terms are nearly dependent
constexpr double largestResidual = 1;  ///< of logarithms, from which on Huber's function is linear
constexpr int robustSteps = 6;
constexpr double pictureWeight = 16;  ///< of lit pixels, where all pairs have 1
/// Pairs by which a projection sees peaks; all of them give the same errors.
constexpr std::ptrdiff_t mostPeaks = 3000;
constexpr int ridgeNodes = 91;

double logarithm(double f, const Brdf& brdf) {
    if (!std::isfinite(f))
        throw NumericError(fmt::format("{}: f is not finite at a pair", brdf.name()));
    return std::log(std::max(f, 0.0) + logOffset);
}

/// ln(f + logOffset), [pair][channel].
Eigen::MatrixXd logarithms(const Brdf& brdf, const PairSample& pairs) {
    const std::size_t channels = brdf.channels().count();
    const std::vector<double> values = evaluateOn(brdf, pairs, true);
    Eigen::MatrixXd out(pairs.size(), channels);
    for (std::size_t n = 0; n < values.size(); ++n) {
        out(static_cast<Eigen::Index>(n % pairs.size()),
            static_cast<Eigen::Index>(n / pairs.size())) = logarithm(values[n], brdf);
    }
    return out;
}

/// The same at single pairs.
Eigen::MatrixXd logarithms(const Brdf& brdf, const std::vector<DirectionPair>& pairs) {
    const std::size_t channels = brdf.channels().count();
    Eigen::MatrixXd out(pairs.size(), channels);
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const std::vector<double> f = evaluate(brdf, pairs[n].wi, pairs[n].wo);
        for (std::size_t c = 0; c < channels; ++c)
            out(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(c)) = logarithm(f[c], brdf);
    }
    return out;
}

/// Logarithms whose distance from `sums` is at most largestResidual.
Eigen::MatrixXd limited(const Eigen::MatrixXd& sums, const Eigen::MatrixXd& logs) {
    return sums + (logs - sums).cwiseMax(-largestResidual).cwiseMin(largestResidual);
}

/// The sum of w x x^T over rows x of terms is added to `gram`, of w x y to `right`.
void addSquares(const linear_algebra::RowMajor& terms, const Eigen::VectorXd& weights,
                const Eigen::VectorXd& values, Eigen::MatrixXd& gram, Eigen::VectorXd& right) {
    const Eigen::MatrixXd weighted = terms.transpose() * weights.cwiseSqrt().asDiagonal();
    gram.selfadjointView<Eigen::Lower>().rankUpdate(weighted);
    right += terms.transpose() * weights.cwiseProduct(values);
}

/// The pairs with the largest of the weights, in their order.
std::vector<Eigen::Index> heaviest(const Eigen::VectorXd& weights) {
    std::vector<Eigen::Index> rows(static_cast<std::size_t>(weights.size()));
    std::iota(rows.begin(), rows.end(), Eigen::Index{0});
    const auto last = rows.begin() + std::min<std::ptrdiff_t>(mostPeaks, weights.size());
    const auto heavier = [&](Eigen::Index a, Eigen::Index b) {
        return weights[a] != weights[b] ? weights[a] > weights[b] : a < b;
    };
    std::ranges::nth_element(rows, last, heavier);
    rows.erase(last, rows.end());
    std::ranges::sort(rows);
    return rows;
}

/// The numbers c of a material moved towards what pictures see of the source, and its peaks: the
/// least of |d|^2 + sum of u r^2 + 16 sum of w r^2, d the change, r the residuals, u and w the
/// weights of Encoder. `logs` at all pairs, `seen` at those of pictures; outliers as in the fit.
Eigen::MatrixXd asSeen(const LogSamples& samples, const Eigen::MatrixXd& c,
                       const Eigen::MatrixXd& logs, const Eigen::MatrixXd& seen) {
    const Eigen::MatrixXd atLit = limited(samples.seen.terms * c, seen),
                          atAll = limited(samples.terms * c, logs),
                          pictures = pictureWeight * samples.seen.weights(atLit),
                          peaks = samples.peakWeights(atAll, 1);
    Eigen::MatrixXd moved(c.rows(), c.cols());
    for (Eigen::Index k = 0; k < c.cols(); ++k) {
        Eigen::MatrixXd gram = samples.metric;
        Eigen::VectorXd right = samples.metric * c.col(k);
        const std::vector<Eigen::Index> rows = heaviest(peaks.col(k));
        addSquares(samples.seen.terms, pictures.col(k), atLit.col(k), gram, right);
        addSquares(samples.terms(rows, Eigen::all), peaks.col(k)(rows), atAll.col(k)(rows), gram,
                   right);
        moved.col(k) = gram.selfadjointView<Eigen::Lower>().llt().solve(right);
    }
    return moved;
}

/// The greatest ln(f + logOffset) of each channel where wi mirrors wo.
std::vector<double> ridgeTops(const Brdf& brdf) {
    std::vector<double> tops(brdf.channels().count(), std::log(logOffset));
    for (int n = 0; n < ridgeNodes; ++n) {
        const Direction wo = directionFromAngles(n * pi / 2 / ridgeNodes, 0);
        const std::vector<double> f = evaluate(brdf, mirrored(wo), wo);
        for (std::size_t c = 0; c < f.size(); ++c)
            tops[c] = std::max(tops[c], std::log(std::max(f[c], 0.0) + logOffset));
    }
    return tops;
}

/// Measured::rest of residuals, [pair][channel].
std::vector<float> restOf(Eigen::MatrixXd residuals, const PairSample& pairs) {
    // A grey material has its channel for every colour.
    if (residuals.cols() == 1) residuals = residuals.replicate(1, 3).eval();
    const Eigen::MatrixXd squares = (residuals * planeMatrix().transpose()).cwiseAbs2();
    std::array<double, restRows> sums{};
    std::array<double, restZones> counts{};
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const auto row = squares.row(static_cast<Eigen::Index>(n));
        const std::size_t zone = restZone(pairs.incoming(n), pairs.outgoing(n));
        counts[zone] += 1;
        sums[zone] += row[0];
        sums[restZones + zone] += (row[1] + row[2]) / 2;
    }
    std::vector<float> means;
    for (std::size_t k = 0; k < restRows; ++k)
        means.push_back(static_cast<float>(sums[k] / std::max(counts[k % restZones], 1.0)));
    return means;
}

}  // namespace

std::size_t restZone(const Direction& wi, const Direction& wo) {
    static const std::array<double, 3> low{std::cos(radians(60)), std::cos(radians(75)),
                                           std::cos(radians(85))};
    static const std::array<double, 2> half{std::cos(radians(2)), std::cos(radians(20))};
    const Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    const double lowest = std::min(wi.z, wo.z), cosine = h.z / std::sqrt(dot(h, h));
    std::size_t zone = 0;
    for (const double edge : low) zone += lowest < edge ? half.size() + 1 : 0;
    for (const double edge : half) zone += cosine < edge ? 1 : 0;
    return zone;
}

Eigen::Matrix3d planeMatrix() {
    Eigen::Matrix3d q;
    q << 1, 1, 1, 1, 0, -1, 1, -2, 1;
    return q.rowwise().normalized();
}

LogMaterial Measured::material() const {
    return {{exponents.begin(), exponents.end()}, {tops.begin(), tops.end()}};
}

LogSamples::LogSamples() : pairs(spreadPairs({.seed = fittedSeed, .incoming = fittedIncoming})) {
    const auto size = static_cast<Eigen::Index>(pairs.size());
    const auto count = static_cast<Eigen::Index>(logTerms().size());
    weights.resize(size);
    terms.resize(size, count);
    for (Eigen::Index k = 0; k < size; ++k) {
        const auto n = static_cast<std::size_t>(k);
        logTerms().evaluate(pairs.incoming(n), pairs.outgoing(n), terms.row(k).data());
        weights[k] = (1 - byPair) * pairs.weights[n] + byPair / static_cast<double>(size);
    }
    metric = terms.transpose() * (weights.asDiagonal() * terms);
    metric.diagonal().array() += ridge * metric.trace() / static_cast<double>(count);
    lower = metric.llt().matrixL();
}

Eigen::Map<const linear_algebra::RowMajor, 0, Eigen::OuterStride<>> LogSamples::few() const {
    return {terms.data(), terms.rows() / peakStep, terms.cols(),
            Eigen::OuterStride<>(peakStep * terms.cols())};
}

Eigen::MatrixXd LogSamples::peakLogs(const LogMaterial& material) const {
    const auto channels = static_cast<Eigen::Index>(material.channels());
    Eigen::MatrixXd logs = few() * Eigen::Map<const Eigen::MatrixXd>(material.exponents.data(),
                                                                     terms.cols(), channels);
    for (Eigen::Index c = 0; c < channels; ++c)
        logs.col(c) = logs.col(c).cwiseMin(material.tops[static_cast<std::size_t>(c)]);
    return logs;
}

Eigen::MatrixXd LogSamples::peakWeights(const Eigen::MatrixXd& logs, Eigen::Index step) const {
    Eigen::MatrixXd peaks(logs.rows(), logs.cols());
    for (Eigen::Index c = 0; c < logs.cols(); ++c) {
        const double greatest = std::exp(logs.col(c).maxCoeff());  // squares stay finite
        for (Eigen::Index n = 0; n < logs.rows(); ++n) {
            const auto k = static_cast<std::size_t>(n * step);
            const double f = std::max(std::exp(logs(n, c)) - logOffset, 0.0) / greatest;
            peaks(n, c) = pairs.weights[k] * std::pow(f * pairs.z[k], 2);
        }
        peaks.col(c) /= std::max(peaks.col(c).sum(), 1e-300);
    }
    return peaks;
}

Eigen::MatrixXd LogSamples::solve(Eigen::MatrixXd right) const {
    lower.triangularView<Eigen::Lower>().solveInPlace(right);
    lower.transpose().triangularView<Eigen::Upper>().solveInPlace(right);
    return right;
}

LogSpace::LogSpace() : samples_(std::make_unique<LogSamples>()) {}
LogSpace::~LogSpace() = default;

Measured LogSpace::project(const Brdf& brdf, const std::string& name, const std::string& source,
                           bool seen) const {
    const std::size_t channels = brdf.channels().count();
    if (brdf.channels().kind == Channels::Kind::spectral)
        throw UsageError(
            fmt::format("{}: is spectral; a library holds grey and RGB materials, so "
                        "give rgb:{}",
                        source, source));
    const Eigen::MatrixXd logs = logarithms(brdf, samples_->pairs);
    const auto fit = [&](const Eigen::MatrixXd& y) {
        return samples_->solve(samples_->terms.transpose() * (samples_->weights.asDiagonal() * y));
    };
    Eigen::MatrixXd c = fit(logs);
    for (int step = 0; step < robustSteps; ++step) {
        const Eigen::MatrixXd sums = samples_->terms * c, rest = logs - sums;
        if (rest.cwiseAbs().maxCoeff() <= largestResidual) break;
        c = fit(sums + rest.cwiseMax(-largestResidual).cwiseMin(largestResidual));
    }
    c = asSeen(*samples_, c, logs, logarithms(brdf, samples_->seen.pairs));
    Measured measured{.name = name, .source = source, .exponents = {}, .tops = {}};
    const std::vector<double> ridgeTop = ridgeTops(brdf);
    for (std::size_t k = 0; k < channels; ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        for (const double value : c.col(column))
            measured.exponents.push_back(static_cast<float>(value));
        measured.tops.push_back(
            static_cast<float>(std::max(ridgeTop[k], logs.col(column).maxCoeff())));
    }
    const LogBrdf form(measured.material(), name);
    measured.rest = restOf(logs - samples_->terms * c, samples_->pairs);
    measured.error = formError(brdf, form, errorPairs());
    if (seen) measured.error.flip = pictureError(brdf, form).flip.mean;
    return measured;
}

}  // namespace hshfit::material_library
