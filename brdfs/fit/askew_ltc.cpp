#include <brdfs/fit/askew_ltc.h>

#include <hshfit/error.h>

#include <ceres/ceres.h>
#include <Eigen/LU>

#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr int askewParameters = 7;

template <class Number>
using AskewMatrix = Eigen::Matrix<Number, 3, 3>;

template <class Number>
AskewMatrix<Number> askewMatrix(const std::array<Number, askewParameters>& p) {
    AskewMatrix<Number> m;
    m << p[0], Number(0), p[1], p[2], Number(1), p[3], p[4], p[5], p[6];
    return m;
}

Eigen::Matrix3d matrixOf(const AskewLtc& w) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(w.front().data());
}
AskewLtc rowsOf(const Eigen::Matrix3d& m) {
    AskewLtc w;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) w[row][column] = m(row, column);
    return w;
}

constexpr std::array<double, askewParameters> identity{1, 0, 0, 0, 0, 0, 1};

/// Residuals as in CubedError (ltc_lobe.cpp), for a change of the reference's matrix.
class AskewCubedError final : public ceres::SizedCostFunction<ceres::DYNAMIC, askewParameters> {
public:
    AskewCubedError(const LobeSamples& samples, const Eigen::Matrix3d& reference)
        : samples_(samples) {
        set_num_residuals(static_cast<int>(samples.wi.size()));
        double cubes = 0;
        for (std::size_t k = 0; k < samples.wi.size(); ++k) {
            const Direction& d = samples.wi[k];
            taken_.emplace_back(reference * Eigen::Vector3d(d.x, d.y, d.z));
            const double value = samples.values[k];
            magnitude_ += samples.weights[k] * value;
            cubes += samples.weights[k] * value * value * value;
        }
        scale_ = std::cbrt(1 / cubes);
        determinant_ = reference.determinant();
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        using Jet = ceres::Jet<double, askewParameters>;
        std::array<Jet, askewParameters> p;
        for (int k = 0; k < askewParameters; ++k) p[k] = {parameters[0][k], k};
        const AskewMatrix<Jet> change = askewMatrix(p);
        const Jet determinant = change.determinant();
        if (!(determinant.a > 0)) return false;
        for (std::size_t k = 0; k < taken_.size(); ++k) {
            const Eigen::Vector3d& u = taken_[k];
            const Jet x = change(0, 0) * u.x() + change(0, 2) * u.z();
            const Jet y = change(1, 0) * u.x() + u.y() + change(1, 2) * u.z();
            const Jet z = change(2, 0) * u.x() + change(2, 1) * u.y() + change(2, 2) * u.z();
            const Jet square = x * x + y * y + z * z;
            const double factor = magnitude_ * determinant_ * scale_ / pi;
            const Jet lobe = z.a > 0 ? determinant * z / (square * square) : Jet(0);
            const double difference = factor * lobe.a - scale_ * samples_.values[k];
            const double root = std::sqrt(std::abs(difference) * samples_.weights[k]);
            residuals[k] = difference * root;
            if (!jacobians || !jacobians[0]) continue;
            for (int i = 0; i < askewParameters; ++i)
                jacobians[0][askewParameters * k + i] = 1.5 * root * factor * lobe.v[i];
        }
        return true;
    }

private:
    const LobeSamples& samples_;
    std::vector<Eigen::Vector3d> taken_;  ///< to the reference's cosine
    double magnitude_ = 0, determinant_ = 1, scale_ = 1;
};

double cubedError(const LobeSamples& samples, const AskewLtc& w) {
    double magnitude = 0, cubes = 0, differences = 0;
    for (std::size_t k = 0; k < samples.wi.size(); ++k)
        magnitude += samples.weights[k] * samples.values[k];
    for (std::size_t k = 0; k < samples.wi.size(); ++k) {
        const double value = samples.values[k];
        cubes += samples.weights[k] * value * value * value;
        differences += samples.weights[k] *
                       std::pow(std::abs(value - magnitude * density(w, samples.wi[k])), 3);
    }
    return std::cbrt(differences / cubes);
}

}  // namespace

AskewLtc inStandardForm(const AskewLtc& w) {
    const double across = std::hypot(w[0][1], w[1][1]);
    if (!(across > 0))
        throw NumericError("the matrix of a transformed cosine takes y to z, and has no such form");
    const double c = w[1][1] / across, s = w[0][1] / across;
    AskewLtc form;
    for (std::size_t k = 0; k < 3; ++k) {
        form[0][k] = (c * w[0][k] - s * w[1][k]) / across;
        form[1][k] = (s * w[0][k] + c * w[1][k]) / across;
        form[2][k] = w[2][k] / across;
    }
    form[0][1] = 0;
    return form;
}

double density(const AskewLtc& w, const Direction& d) {
    const Eigen::Matrix3d m = matrixOf(w);
    const Eigen::Vector3d u = m * Eigen::Vector3d(d.x, d.y, d.z);
    if (!(u.z() > 0)) return 0;
    const double square = u.squaredNorm();
    return std::abs(m.determinant()) * u.z() / (pi * square * square);
}

AskewLtc turnedAboutY(const AskewLtc& w, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    Eigen::Matrix3d back;  // of directions
    back << c, 0, -s, 0, 1, 0, s, 0, c;
    return rowsOf(matrixOf(w) * back);
}

AskewFit fitAskewLtc(const LobeSamples& samples, const AskewLtc& start) {
    AskewFit fit{.w = inStandardForm(start)};
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 60;
    options.function_tolerance = 1e-8;
    options.num_threads = 1;
    // Numbers are of order 1 in the frame of the last result, however narrow the lobe.
    for (int round = 0; round < 3; ++round) {
        std::array<double, askewParameters> p = identity;
        ceres::Problem::Options own;
        own.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        AskewCubedError cost(samples, matrixOf(fit.w));
        ceres::Problem problem(own);
        problem.AddResidualBlock(&cost, nullptr, p.data());
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        fit.w = inStandardForm(rowsOf(askewMatrix(p) * matrixOf(fit.w)));
        double moved = 0;
        for (int k = 0; k < askewParameters; ++k)
            moved = std::max(moved, std::abs(p[k] - identity[k]));
        if (moved < 1e-3) break;
    }
    fit.error = cubedError(samples, fit.w);
    return fit;
}

}  // namespace hshfit::brdfs
