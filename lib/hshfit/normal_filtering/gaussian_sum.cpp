#include <hshfit/normal_filtering/internal/gaussian_sum.h>

#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline normal_filtering {
namespace {

/// The unit vector whose projection in equal areas is (x, y), at most sqrt(2) from the pole.
Direction fromDisc(double x, double y) {
    const double square = x * x + y * y;
    const double factor = std::sqrt(std::max(0.0, 1 - square / 4));
    return {x * factor, y * factor, 1 - square / 2};
}

/// Least squares over the columns in `passive`; 0 elsewhere.
Eigen::VectorXd restricted(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                           const std::vector<bool>& passive) {
    std::vector<Eigen::Index> chosen;
    for (std::size_t j = 0; j < passive.size(); ++j)
        if (passive[j]) chosen.push_back(static_cast<Eigen::Index>(j));
    Eigen::MatrixXd part(a.rows(), static_cast<Eigen::Index>(chosen.size()));
    for (std::size_t k = 0; k < chosen.size(); ++k)
        part.col(static_cast<Eigen::Index>(k)) = a.col(chosen[k]);
    const Eigen::VectorXd solved = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(part).solve(b);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
    for (std::size_t k = 0; k < chosen.size(); ++k)
        x[chosen[k]] = solved[static_cast<Eigen::Index>(k)];
    return x;
}

}  // namespace

std::vector<double> nonNegativeLeastSquares(const std::vector<std::vector<double>>& columns,
                                            const std::vector<double>& b) {
    const auto rows = static_cast<Eigen::Index>(b.size());
    const std::size_t n = columns.size();
    Eigen::MatrixXd a(rows, static_cast<Eigen::Index>(n));
    for (std::size_t j = 0; j < n; ++j)
        a.col(static_cast<Eigen::Index>(j)) =
            Eigen::Map<const Eigen::VectorXd>(columns[j].data(), rows);
    const Eigen::Map<const Eigen::VectorXd> right(b.data(), rows);
    const Eigen::VectorXd least = 1e-12 * right.norm() * a.colwise().norm().transpose();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
    std::vector<bool> passive(n, false);
    for (std::size_t step = 0; step < 3 * n; ++step) {
        const Eigen::VectorXd gradient = a.transpose() * (right - a * x);
        Eigen::Index best = -1;
        for (Eigen::Index j = 0; j < a.cols(); ++j)
            if (!passive[static_cast<std::size_t>(j)] && gradient[j] > least[j] &&
                (best < 0 || gradient[j] > gradient[best]))
                best = j;
        if (best < 0) break;
        passive[static_cast<std::size_t>(best)] = true;
        for (;;) {
            const Eigen::VectorXd next = restricted(a, right, passive);
            double share = 1;  // of the way to `next` on which all stay at or above 0
            for (Eigen::Index j = 0; j < a.cols(); ++j)
                if (passive[static_cast<std::size_t>(j)] && next[j] <= 0)
                    share = std::min(share, x[j] / (x[j] - next[j]));
            if (share >= 1) {
                x = next;
                break;
            }
            x += share * (next - x);
            for (Eigen::Index j = 0; j < a.cols(); ++j)
                if (passive[static_cast<std::size_t>(j)] && next[j] <= 0 && x[j] < 1e-14) {
                    passive[static_cast<std::size_t>(j)] = false;
                    x[j] = 0;
                }
        }
    }
    return {x.begin(), x.end()};
}

GaussianSum fitGaussians(const NormalDistribution& distribution) {
    const double wx = distribution.widthX, wy = distribution.widthY;
    // Chords r in units of the width, to the horizon along the narrower axis, in steps of 8 %.
    const double far = std::sqrt(2.0) / std::max(wx, wy);
    std::vector<double> radii, values;
    for (double r = 0.02 * std::min(1.0, far); r < far; r *= 1.08) {
        double sum = 0;
        constexpr int azimuths = 16;
        for (int k = 0; k < azimuths; ++k) {
            const double phi = 2 * pi * (k + 0.5) / azimuths;
            sum += distribution.density(fromDisc(wx * r * std::cos(phi), wy * r * std::sin(phi)));
        }
        radii.push_back(r);
        values.push_back(sum / azimuths * wx * wy);
    }
    const double peak = *std::max_element(values.begin(), values.end());
    GaussianSum sum;
    std::vector<double> candidates;
    for (double variance = 1.0 / 32; variance < 4 * far * far; variance *= 2)
        candidates.push_back(variance);
    std::vector<std::vector<double>> columns(candidates.size());
    std::vector<double> right;
    for (std::size_t i = 0; i < radii.size(); ++i) {
        const double r = radii[i], area = r * r;
        const double weight = std::sqrt(area / (values[i] + 1e-3 * peak));
        right.push_back(weight * values[i]);
        for (std::size_t j = 0; j < candidates.size(); ++j)
            columns[j].push_back(weight * std::exp(-r * r / (2 * candidates[j])));
    }
    const std::vector<double> peaks = nonNegativeLeastSquares(columns, right);
    for (std::size_t j = 0; j < peaks.size(); ++j) {
        if (peaks[j] <= 0) continue;
        sum.peaks.push_back(peaks[j]);
        sum.variances.push_back(candidates[j]);
    }
    double distance = 0, norm = 0;
    for (std::size_t i = 0; i < radii.size(); ++i) {
        double value = 0;
        for (std::size_t j = 0; j < sum.peaks.size(); ++j)
            value += sum.peaks[j] * std::exp(-radii[i] * radii[i] / (2 * sum.variances[j]));
        const double area = radii[i] * radii[i];
        distance += area * (value - values[i]) * (value - values[i]);
        norm += area * values[i] * values[i];
    }
    sum.error = std::sqrt(distance / norm);
    return sum;
}

}  // namespace hshfit::inline normal_filtering
