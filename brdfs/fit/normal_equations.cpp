#include <brdfs/fit/normal_equations.h>

#include <brdfs/fit/column_blocks.h>

#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct Block {
    std::size_t begin, size;
};

std::vector<Block> blocksOf(std::size_t count) {
    std::vector<Block> blocks;
    for (std::size_t begin = 0; begin < count; begin += ColumnBlocks::blockSize)
        blocks.push_back({begin, std::min(ColumnBlocks::blockSize, count - begin)});
    return blocks;
}

/// `work(block)` for all blocks on all threads; the results added in the order of the blocks.
template <class Sums, class Work>
Sums sumOverBlocks(std::size_t count, Sums total, const Work& work) {
    const std::vector<Block> blocks = blocksOf(count);
    constexpr std::size_t atOnce = 64;
    std::vector<Sums> sums;
    for (std::size_t first = 0; first < blocks.size(); first += atOnce) {
        sums.assign(std::min(atOnce, blocks.size() - first), total);
        tbb::parallel_for(std::size_t{0}, sums.size(),
                          [&](std::size_t i) { sums[i] = work(blocks[first + i]); });
        for (const Sums& part : sums) total.add(part);
    }
    return total;
}

struct Gram {
    Matrix matrix;
    void add(const Gram& other) { matrix += other.matrix; }
};

/// [columns and derivatives][data of `channels`], weighted inner products. `roots` of weights.
Matrix gramOf(const FitSamples& samples, const ColumnBlocks& columns,
              const std::vector<double>& roots, const std::vector<std::size_t>& channels) {
    const auto rows = static_cast<Eigen::Index>(columns.count() + channels.size());
    const Gram zero{Matrix::Zero(rows, rows)};
    const auto work = [&](const Block& block) {
        const auto size = static_cast<Eigen::Index>(block.size);
        Matrix z(size, rows);
        columns.fill(block.begin, block.size, z.data());
        for (std::size_t c = 0; c < channels.size(); ++c)
            for (Eigen::Index k = 0; k < size; ++k)
                z(k, static_cast<Eigen::Index>(columns.count() + c)) =
                    samples.value(channels[c], block.begin + static_cast<std::size_t>(k));
        const Eigen::Map<const Vector> root(roots.data() + block.begin, size);
        z.array().colwise() *= root.array();
        Gram result = zero;
        result.matrix.selfadjointView<Eigen::Lower>().rankUpdate(z.transpose());
        return result;
    };
    Matrix matrix = sumOverBlocks(samples.size(), zero, work).matrix;
    matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
    return matrix;
}

struct JointSums {
    double cost = 0;
    Matrix gram;    ///< of [jacobian, residual]
    Matrix spread;  ///< of jacobian times weighted residual; empty unless asked for
    void add(const JointSums& other) {
        cost += other.cost, gram += other.gram;
        if (spread.size() > 0) spread += other.spread;
    }
};

}  // namespace

FitProblem::FitProblem(const FitSamples& samples, const ParametricSum& sum, Loss::Kind loss)
    : samples_(samples), sum_(sum), loss_(loss) {
    const bool linear = loss == Loss::Kind::l2 || loss == Loss::Kind::cosine;
    projectionWeights_.resize(linear ? 1 : channels());
    double squares = 0, weights = 0;
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const Mapped g = mapValue(loss, samples.value(c, k), samples.wiZ[k]);
            squares += samples.weights[k] * g.value * g.value;
            weights += samples.weights[k];
            if (c < projectionWeights_.size())
                projectionWeights_[c].push_back(std::sqrt(samples.weights[k]) * g.slope);
        }
    normalisation_ = squares > 0 ? squares : weights;
}

Equations FitProblem::eliminated(std::span<const double> u, bool derivatives,
                                 std::vector<double>& linear) const {
    const ColumnBlocks columns(samples_, sum_, u, derivatives);
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size();
    const auto n = static_cast<Eigen::Index>(shapes);
    linear.assign(linearCount(), 0.0);
    std::vector<double> lower, upper;
    for (const LinearParameter& parameter : sum_.linears()) {
        lower.push_back(parameter.min);
        upper.push_back(parameter.max);
    }
    Matrix hessian = Matrix::Zero(n, n);
    Vector gradient = Vector::Zero(n);
    Equations result;
    Matrix gram;
    for (std::size_t c = 0; c < channels(); ++c) {
        const bool shared = projectionWeights_.size() == 1;
        std::vector<std::size_t> all(channels());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
        if (c == 0 || !shared)
            gram = gramOf(samples_, columns, projectionWeights_[shared ? 0 : c],
                          shared ? all : std::vector<std::size_t>{c});
        const auto data = static_cast<Eigen::Index>(columns.count() + (shared ? c : 0));
        const auto count = static_cast<Eigen::Index>(terms);
        const Matrix a = gram.block(1, 1, count, count);
        const Vector b = gram.col(data).segment(1, count) - gram.col(0).segment(1, count);
        const std::vector<double> best =
            solveBounded({a.data(), terms * terms}, {b.data(), terms}, lower, upper);
        // The residual and the derivatives of f, as combinations of the columns.
        Vector residual = Vector::Zero(gram.rows());
        residual(data) = -1, residual(0) = 1;
        std::vector<Eigen::Index> free;
        for (std::size_t k = 0; k < terms; ++k) {
            linear[k * channels() + c] = best[k];
            const auto column = static_cast<Eigen::Index>(1 + k);
            residual(column) = best[k];
            if (best[k] > lower[k] && best[k] < upper[k]) free.push_back(column);
        }
        const Vector against = gram * residual;
        result.cost += std::max(0.0, 0.5 * residual.dot(against));
        if (!derivatives) continue;
        Matrix slopes = Matrix::Zero(gram.rows(), n);
        for (std::size_t j = 0; j < shapes; ++j) {
            const auto first = static_cast<Eigen::Index>(columns.derivative(j));
            const auto& own = sum_.linearsOf(j);
            slopes(first, static_cast<Eigen::Index>(j)) = 1;
            for (std::size_t i = 0; i < own.size(); ++i)
                slopes(first + 1 + static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                    best[own[i]];
        }
        const Matrix applied = gram * slopes;
        hessian += slopes.transpose() * applied;
        gradient += slopes.transpose() * against;
        if (free.empty()) continue;
        const auto freeCount = static_cast<Eigen::Index>(free.size());
        Matrix within(freeCount, freeCount), across(freeCount, n);
        for (Eigen::Index i = 0; i < freeCount; ++i) {
            across.row(i) = applied.row(free[i]);
            for (Eigen::Index j = 0; j < freeCount; ++j) within(i, j) = gram(free[i], free[j]);
        }
        hessian -= across.transpose() *
                   Eigen::CompleteOrthogonalDecomposition<Matrix>(within).solve(across);
    }
    result.cost /= normalisation_;
    if (!derivatives) return result;
    hessian = (hessian + hessian.transpose()) / (2 * normalisation_);
    gradient /= normalisation_;
    result.gradient.assign(gradient.data(), gradient.data() + n);
    result.hessian.assign(hessian.data(), hessian.data() + n * n);
    return result;
}

Equations FitProblem::joint(std::span<const double> x, bool derivatives, bool spread) const {
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size();
    const ColumnBlocks columns(samples_, sum_, x.first(shapes), derivatives);
    const auto n = static_cast<Eigen::Index>(shapes + terms);
    JointSums zero;
    zero.gram = Matrix::Zero(derivatives ? n + 1 : 1, derivatives ? n + 1 : 1);
    if (spread) zero.spread = Matrix::Zero(n, n);
    const auto total = static_cast<Eigen::Index>(x.size());
    Matrix hessian = Matrix::Zero(total, total),
           meat = Matrix::Zero(spread ? total : 0, spread ? total : 0);
    Vector gradient = Vector::Zero(total);
    Equations result;
    for (std::size_t c = 0; c < channels(); ++c) {
        std::vector<double> linear;
        for (std::size_t k = 0; k < terms; ++k) linear.push_back(x[shapes + k * channels() + c]);
        const auto work = [&](const Block& block) {
            const auto size = static_cast<Eigen::Index>(block.size);
            Matrix z(size, static_cast<Eigen::Index>(columns.count()));
            columns.fill(block.begin, block.size, z.data());
            Vector f = z.col(0);
            for (std::size_t k = 0; k < terms; ++k)
                f += linear[k] * z.col(static_cast<Eigen::Index>(1 + k));
            JointSums sums = zero;
            Matrix rows(size, zero.gram.rows());
            if (derivatives) {
                for (std::size_t j = 0; j < shapes; ++j) {
                    const auto first = static_cast<Eigen::Index>(columns.derivative(j));
                    const auto& own = sum_.linearsOf(j);
                    auto slope = rows.col(static_cast<Eigen::Index>(j));
                    slope = z.col(first);
                    for (std::size_t i = 0; i < own.size(); ++i)
                        slope += linear[own[i]] * z.col(first + 1 + static_cast<Eigen::Index>(i));
                }
                rows.middleCols(static_cast<Eigen::Index>(shapes),
                                static_cast<Eigen::Index>(terms)) =
                    z.middleCols(1, static_cast<Eigen::Index>(terms));
            }
            Vector pull(size);
            for (Eigen::Index k = 0; k < size; ++k) {
                const std::size_t at = block.begin + static_cast<std::size_t>(k);
                const double cosine = samples_.wiZ[at], weight = samples_.weights[at];
                const Mapped own = mapValue(loss_, f(k), cosine);
                const double r = own.value - mapValue(loss_, samples_.value(c, at), cosine).value;
                const Kernel kernel = applyKernel(robust_, scale_, r * r);
                sums.cost += 0.5 * weight * kernel.value;
                const double root = std::sqrt(weight * kernel.slope);
                rows(k, rows.cols() - 1) = root * r;
                if (derivatives) rows.row(k).head(n) *= root * own.slope;
                pull(k) = root * r;
            }
            sums.gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
            if (spread) {
                Matrix pulled = rows.leftCols(n);
                pulled.array().colwise() *= pull.array();
                sums.spread.selfadjointView<Eigen::Lower>().rankUpdate(pulled.transpose());
            }
            return sums;
        };
        JointSums sums = sumOverBlocks(samples_.size(), zero, work);
        result.cost += sums.cost;
        if (!derivatives) continue;
        sums.gram.triangularView<Eigen::StrictlyUpper>() = sums.gram.transpose();
        // Where the parameters of this channel stand among all.
        const auto at = [&](Eigen::Index i) {
            return i < static_cast<Eigen::Index>(shapes)
                       ? i
                       : static_cast<Eigen::Index>(
                             shapes + (static_cast<std::size_t>(i) - shapes) * channels() + c);
        };
        if (spread) sums.spread.triangularView<Eigen::StrictlyUpper>() = sums.spread.transpose();
        for (Eigen::Index i = 0; i < n; ++i) {
            gradient(at(i)) += sums.gram(i, n);
            for (Eigen::Index j = 0; j < n; ++j) {
                hessian(at(i), at(j)) += sums.gram(i, j);
                if (spread) meat(at(i), at(j)) += sums.spread(i, j);
            }
        }
    }
    result.cost /= normalisation_;
    if (!derivatives) return result;
    gradient /= normalisation_, hessian /= normalisation_;
    result.gradient.assign(gradient.data(), gradient.data() + total);
    result.hessian.assign(hessian.data(), hessian.data() + total * total);
    if (spread) {
        meat /= normalisation_ * normalisation_;
        result.spread.assign(meat.data(), meat.data() + total * total);
    }
    return result;
}

std::vector<double> FitProblem::values(std::span<const double> x) const {
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size();
    const ColumnBlocks columns(samples_, sum_, x.first(shapes), false);
    const std::size_t count = samples_.size();
    std::vector<double> result(channels() * count);
    const std::vector<Block> blocks = blocksOf(count);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        const Block& block = blocks[b];
        std::vector<double> z(columns.count() * block.size);
        columns.fill(block.begin, block.size, z.data());
        for (std::size_t c = 0; c < channels(); ++c)
            for (std::size_t k = 0; k < block.size; ++k) {
                double f = z[k];
                for (std::size_t i = 0; i < terms; ++i)
                    f += x[shapes + i * channels() + c] * z[(1 + i) * block.size + k];
                result[c * count + block.begin + k] = f;
            }
    });
    return result;
}

std::vector<double> FitProblem::residuals(std::span<const double> x) const {
    std::vector<double> result = values(x);
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            double& r = result[c * samples_.size() + k];
            r = mapValue(loss_, r, samples_.wiZ[k]).value -
                mapValue(loss_, samples_.value(c, k), samples_.wiZ[k]).value;
        }
    return result;
}

}  // namespace hshfit::brdfs
