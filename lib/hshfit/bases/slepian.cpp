#include <hshfit/bases/internal/slepian.h>

#include <hshfit/bases/sh.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <mutex>

namespace hshfit::bases {

namespace {

using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Combinations of Y_l^m, l = m .. 2 order - 1, one a row, best concentrated first. The commuting
/// matrix for a cap of half angle pi / 2 (Simons et al. 2006, eq. 4.13 ff.) has a zero diagonal and
///     T_{l,l+1} = [l (l + 2) - L (L + 2)] sqrt(((l+1)^2 - m^2) / ((2l + 1)(2l + 3))),  L = 2n - 1;
/// its lowest eigenvalue belongs to the best concentrated function.
Table combinations(int order, int m) {
    const int top = 2 * order - 1, size = top - m + 1;
    const Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size);
    Eigen::VectorXd beside(size - 1);
    for (int l = m; l < top; ++l) {
        const double ll = l, mm = m;
        beside(l - m) = (ll * (ll + 2) - top * (top + 2.0)) *
                        std::sqrt((ll + 1 - mm) * (ll + 1 + mm) / ((2 * ll + 1) * (2 * ll + 3)));
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, beside);
    assert(solver.info() == Eigen::Success);
    Table rows = solver.eigenvectors().leftCols(order - m).transpose();
    // Positive next to the pole, where Y_l^m ~ atPole_l theta^m.
    Eigen::VectorXd atPole = Eigen::VectorXd::Ones(size);
    for (int l = m; l < top; ++l)
        atPole(l + 1 - m) = atPole(l - m) * std::sqrt((2.0 * l + 3) / (2.0 * l + 1) *
                                                      (l + 1.0 + m) / (l + 1.0 - m));
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
        if (rows.row(i).dot(atPole) < 0) rows.row(i) *= -1;
    return rows;
}

class Slepian final : public Basis {
public:
    Slepian(int order, BasisOptions options)
        : Basis(order, options),
          harmonics_(makeSh(2 * order, options)),
          once_(std::make_unique<std::once_flag[]>(static_cast<std::size_t>(order))),
          tables_(static_cast<std::size_t>(order)) {}

    std::string name() const override { return "slepian"; }

    void theta(int m, std::span<const Elevation<double>> points, double* out) const override {
        const Table& table = tableOf(m);
        const Table values = harmonicsAt(m, points);
        const std::size_t count = points.size();
        std::fill_n(out, static_cast<std::size_t>(table.rows()) * count, 0.0);
        // Term by term, so that a point's values do not depend on how many points there are.
        for (Eigen::Index i = 0; i < table.rows(); ++i, out += count)
            for (Eigen::Index j = 0; j < table.cols(); ++j) {
                const double factor = table(i, j);
                const double* row = values.data() + static_cast<std::size_t>(j) * count;
                for (std::size_t p = 0; p < count; ++p) out[p] += factor * row[p];
            }
        out -= static_cast<std::size_t>(table.rows()) * count;
        for (std::size_t p = 0; p < count; ++p)
            for (Eigen::Index i = 0; points[p].mu < 0 && i < table.rows(); ++i)
                out[static_cast<std::size_t>(i) * count + p] = 0;
    }

    void theta(int m, std::span<const Elevation<float>> points, float* out) const override {
        std::vector<Elevation<double>> wide;
        for (const Elevation<float>& e : points) wide.push_back({e.mu, e.oneMinusMu});
        std::vector<double> values(static_cast<std::size_t>(order() - m) * points.size());
        theta(m, wide, values.data());
        for (std::size_t i = 0; i < values.size(); ++i) out[i] = static_cast<float>(values[i]);
    }

private:
    Table harmonicsAt(int m, std::span<const Elevation<double>> points) const {
        Table values(2 * order() - m, static_cast<Eigen::Index>(points.size()));
        harmonics_->theta(m, points, values.data());
        return values;
    }

    /// The combinations over the roots of their shares of energy, made when first asked for.
    const Table& tableOf(int m) const {
        const auto column = static_cast<std::size_t>(m);
        std::call_once(once_[column], [&] {
            Table table = combinations(order(), m);
            // Squares are polynomials of degree 4 order - 2 in mu at most.
            const GaussRule& rule = gaussLegendre(2 * order());
            std::vector<Elevation<double>> points;
            for (const double x : rule.nodes) points.push_back({0.5 * (1 + x), 0.5 * (1 - x)});
            const Table values = table * harmonicsAt(m, points);
            const Eigen::Map<const Eigen::VectorXd> weights(
                rule.weights.data(), static_cast<Eigen::Index>(rule.weights.size()));
            const Eigen::VectorXd shares = 0.5 * values.cwiseAbs2() * weights;
            tables_[column] = shares.cwiseSqrt().cwiseInverse().asDiagonal() * table;
        });
        return tables_[column];
    }

    std::unique_ptr<Basis> harmonics_;
    std::unique_ptr<std::once_flag[]> once_;
    mutable std::vector<Table> tables_;
};

}  // namespace

std::unique_ptr<Basis> makeSlepian(int order, BasisOptions options) {
    return std::make_unique<Slepian>(order, options);
}

}  // namespace hshfit::bases
