#include <brdfs/fit/normal_equations.h>

#include <brdfs/fit/column_blocks.h>
#include <brdfs/fit/column_products.h>
#include <brdfs/fit/dense.h>
#include <brdfs/fit/whitening.h>

#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

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

/// Adds columns^T columns to the lower triangle.
void addGram(const Matrix& columns, Matrix& out) {
    const auto rows = static_cast<std::size_t>(columns.rows());
    addGram(ColumnSpan{columns.data(), static_cast<std::size_t>(columns.cols()), rows}, rows,
            out.data(), static_cast<std::size_t>(out.rows()));
}

struct Grams {
    std::vector<Matrix> matrices;
    void add(const Grams& other) {
        for (std::size_t i = 0; i < matrices.size(); ++i) matrices[i] += other.matrices[i];
    }
};

/// [columns and derivatives][data], weighted inner products: one matrix with the data of all
/// channels for weights and columns that they share, else one for each channel. `roots` of weights.
std::vector<Matrix> gramsOf(const FitSamples& samples, const std::vector<ColumnBlocks>& columns,
                            const std::vector<std::vector<double>>& roots) {
    const std::size_t groups = std::max(roots.size(), columns.size()),
                      own = samples.channels.count() / groups;
    const auto first = static_cast<Eigen::Index>(columns[0].count());
    const Eigen::Index rows = first + static_cast<Eigen::Index>(own);
    const Grams zero{std::vector<Matrix>(groups, Matrix::Zero(rows, rows))};
    const auto work = [&](const Block& block) {
        const auto size = static_cast<Eigen::Index>(block.size);
        Matrix filled(size, first);
        Grams result = zero;
        Matrix z(size, rows);
        for (std::size_t i = 0; i < groups; ++i) {
            if (i < columns.size()) columns[i].fill(block.begin, block.size, filled.data());
            z.leftCols(first) = filled;
            for (std::size_t c = 0; c < own; ++c)
                for (Eigen::Index k = 0; k < size; ++k)
                    z(k, first + static_cast<Eigen::Index>(c)) =
                        samples.value(i + c, block.begin + static_cast<std::size_t>(k));
            const Eigen::Map<const Vector> root(
                roots[std::min(i, roots.size() - 1)].data() + block.begin, size);
            z.array().colwise() *= root.array();
            addGram(z, result.matrices[i]);
        }
        return result;
    };
    std::vector<Matrix> matrices = sumOverBlocks(samples.size(), zero, work).matrices;
    for (Matrix& matrix : matrices)
        matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
    return matrices;
}

/// Sums of one channel.
struct ChannelSums {
    double cost = 0;
    Matrix gram;    ///< of [jacobian, residual]
    Matrix spread;  ///< of jacobian times weighted residual; empty unless asked for
};

struct JointSums {
    std::vector<ChannelSums> channels;
    void add(const JointSums& other) {
        for (std::size_t c = 0; c < channels.size(); ++c) {
            channels[c].cost += other.channels[c].cost;
            channels[c].gram += other.channels[c].gram;
            if (channels[c].spread.size() > 0) channels[c].spread += other.channels[c].spread;
        }
    }
};

/// df / d(u, linear) of one channel from the columns of a block; the last column is left free.
Matrix jacobianOf(const ParametricSum& sum, const ColumnBlocks& columns, const Matrix& z,
                  const std::vector<double>& linear) {
    const auto shapes = static_cast<Eigen::Index>(sum.shapes().size());
    const auto terms = static_cast<Eigen::Index>(linear.size());
    Matrix rows(z.rows(), shapes + terms + 1);
    for (Eigen::Index j = 0; j < shapes; ++j) {
        const auto first =
            static_cast<Eigen::Index>(columns.derivative(static_cast<std::size_t>(j)));
        const auto& own = sum.linearsOf(static_cast<std::size_t>(j));
        rows.col(j) = z.col(first);
        for (std::size_t i = 0; i < own.size(); ++i)
            rows.col(j) += linear[own[i]] * z.col(first + 1 + static_cast<Eigen::Index>(i));
    }
    rows.middleCols(shapes, terms) = z.middleCols(1, terms);
    return rows;
}

}  // namespace

FitProblem::FitProblem(const FitSamples& samples, const ParametricSum& sum, Loss::Kind loss)
    : samples_(samples), sum_(sum), loss_(loss) {
    const bool linear = loss == Loss::Kind::l2 || loss == Loss::Kind::cosine;
    projectionWeights_.resize(linear && samples.sigmas.empty() ? 1 : channels());
    mapped_.reserve(channels() * samples.size());
    double squares = 0, weights = 0;
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const Mapped g = mapValue(loss, samples.value(c, k), samples.wiZ[k]);
            const double weight = samples.weight(c, k);
            mapped_.push_back(g.value);
            squares += weight * g.value * g.value;
            weights += weight;
            if (c < projectionWeights_.size())
                projectionWeights_[c].push_back(std::sqrt(weight) * g.slope);
        }
    normalisation_ = squares > 0 ? squares : weights;
    if (samples.correlation.any()) whitening_ = std::make_shared<const Whitening>(samples);
}

bool FitProblem::isLinear() const {
    return !whitening_ && !sum_.channelwise() &&
           (loss_ == Loss::Kind::l2 || loss_ == Loss::Kind::cosine);
}

std::vector<ColumnBlocks> FitProblem::columnsAt(std::span<const double> u, bool derivatives,
                                                std::span<const double> linear) const {
    std::vector<ColumnBlocks> columns;
    if (!sum_.channelwise()) {
        columns.emplace_back(samples_, sum_, u, derivatives);
        return columns;
    }
    for (std::size_t c = 0; c < channels(); ++c) {
        std::vector<double> own;
        for (std::size_t i = c; i < linear.size(); i += channels()) own.push_back(linear[i]);
        columns.emplace_back(samples_, sum_, u, derivatives, c, std::move(own));
    }
    return columns;
}

Equations FitProblem::eliminated(std::span<const double> u, bool derivatives,
                                 std::vector<double>& linear) const {
    linear.clear();
    for (const LinearParameter& parameter : sum_.linears())
        linear.insert(linear.end(), channels(),
                      std::clamp(0.5, parameter.min, std::max(parameter.min, parameter.max)));
    if (sum_.channelwise()) eliminatedAbout(u, false, linear);
    return eliminatedAbout(u, derivatives, linear);
}

Equations FitProblem::eliminatedAbout(std::span<const double> u, bool derivatives,
                                      std::vector<double>& linear) const {
    const std::vector<ColumnBlocks> all = columnsAt(u, derivatives, linear);
    const ColumnBlocks& columns = all[0];
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size();
    const auto n = static_cast<Eigen::Index>(shapes);
    std::vector<double> lower, upper;
    for (const LinearParameter& parameter : sum_.linears()) {
        lower.push_back(parameter.min);
        upper.push_back(parameter.max);
    }
    Matrix hessian = Matrix::Zero(n, n);
    Vector gradient = Vector::Zero(n);
    Equations result;
    const std::vector<Matrix> grams = gramsOf(samples_, all, projectionWeights_);
    const bool shared = grams.size() == 1;
    for (std::size_t c = 0; c < channels(); ++c) {
        const Matrix& gram = grams[shared ? 0 : c];
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

Equations FitProblem::joint(std::span<const double> x, bool derivatives,
                            std::span<const double> inverse) const {
    if (whitening_) return whitenedJoint(x, derivatives, inverse);
    const bool spread = !inverse.empty();
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size();
    const std::vector<ColumnBlocks> all =
        columnsAt(x.first(shapes), derivatives, x.subspan(shapes));
    const ColumnBlocks& columns = all[0];
    const auto n = static_cast<Eigen::Index>(shapes + terms);
    ChannelSums none;
    none.gram = Matrix::Zero(derivatives ? n + 1 : 1, derivatives ? n + 1 : 1);
    if (spread) none.spread = Matrix::Zero(n, n);
    const JointSums zero{std::vector<ChannelSums>(channels(), none)};
    // The places of the parameters of each channel among all.
    const auto total = static_cast<Eigen::Index>(x.size());
    const auto placesOf = [&](std::size_t c) {
        std::vector<Eigen::Index> at;
        for (std::size_t i = 0; i < shapes + terms; ++i)
            at.push_back(
                static_cast<Eigen::Index>(i < shapes ? i : shapes + (i - shapes) * channels() + c));
        return at;
    };

    const auto addChannel = [&](const Block& block, const Matrix& z, std::size_t c,
                                ChannelSums& sums) {
        std::vector<double> linear;
        for (std::size_t k = 0; k < terms; ++k) linear.push_back(x[shapes + k * channels() + c]);
        Vector f = z.col(0);
        for (std::size_t k = 0; k < terms; ++k)
            f += linear[k] * z.col(static_cast<Eigen::Index>(1 + k));
        Matrix rows = derivatives ? jacobianOf(sum_, columns, z, linear) : Matrix(z.rows(), 1);
        Vector root(z.rows()), slope(z.rows());
        for (Eigen::Index k = 0; k < z.rows(); ++k) {
            const std::size_t at = block.begin + static_cast<std::size_t>(k);
            const double cosine = samples_.wiZ[at], weight = samples_.weight(c, at);
            const Mapped mapped = mapValue(loss_, f(k), cosine);
            const double r = mapped.value - mapped_[c * samples_.size() + at];
            const Kernel kernel = applyKernel(robust_, scale_, r * r);
            sums.cost += 0.5 * weight * kernel.value;
            root(k) = std::sqrt(weight * kernel.slope);
            slope(k) = root(k) * mapped.slope;
            rows(k, rows.cols() - 1) = root(k) * r;
        }
        if (derivatives) rows.leftCols(n).array().colwise() *= slope.array();
        addGram(rows, sums.gram);
        if (!spread) return;
        Matrix pulled = rows.leftCols(n);
        const std::vector<Eigen::Index> at = placesOf(c);
        const Matrix own =
            Eigen::Map<const Matrix>(inverse.data(), total, total)(at, at) / normalisation_;
        // Rounding leaves some of 1 - leverage where a sample alone decides.
        constexpr double least = 1e-6;
        const Vector leverage = (pulled * own).cwiseProduct(pulled).rowwise().sum();
        pulled.array().colwise() *= rows.col(n).array() / (1 - leverage.array()).max(least);
        addGram(pulled, sums.spread);
    };
    JointSums sums = sumOverBlocks(samples_.size(), zero, [&](const Block& block) {
        Matrix z(static_cast<Eigen::Index>(block.size), static_cast<Eigen::Index>(columns.count()));
        JointSums result = zero;
        for (std::size_t c = 0; c < channels(); ++c) {
            if (c < all.size()) all[c].fill(block.begin, block.size, z.data());
            addChannel(block, z, c, result.channels[c]);
        }
        return result;
    });

    Matrix hessian = Matrix::Zero(total, total), meat = Matrix::Zero(total, total);
    Vector gradient = Vector::Zero(total);
    Equations result;
    for (std::size_t c = 0; c < channels(); ++c) {
        ChannelSums& own = sums.channels[c];
        result.cost += own.cost / normalisation_;
        if (!derivatives) continue;
        own.gram.triangularView<Eigen::StrictlyUpper>() = own.gram.transpose();
        if (spread) own.spread.triangularView<Eigen::StrictlyUpper>() = own.spread.transpose();
        const std::vector<Eigen::Index> at = placesOf(c);
        for (Eigen::Index i = 0; i < n; ++i) {
            gradient(at[i]) += own.gram(i, n) / normalisation_;
            for (Eigen::Index j = 0; j < n; ++j) {
                hessian(at[i], at[j]) += own.gram(i, j) / normalisation_;
                if (spread)
                    meat(at[i], at[j]) += own.spread(i, j) / (normalisation_ * normalisation_);
            }
        }
    }
    if (!derivatives) return result;
    result.gradient.assign(gradient.data(), gradient.data() + total);
    result.hessian.assign(hessian.data(), hessian.data() + total * total);
    if (spread) result.spread.assign(meat.data(), meat.data() + total * total);
    return result;
}

WeightedRows FitProblem::rowsAt(std::span<const double> x) const {
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size(), count = samples_.size();
    const std::vector<ColumnBlocks> all = columnsAt(x.first(shapes), true, x.subspan(shapes));
    const ColumnBlocks& columns = all[0];
    WeightedRows result{.samples = count, .channels = channels(), .columns = shapes + terms};
    result.slopes.resize(channels() * count * result.columns);
    result.residuals.resize(channels() * count);
    result.values.resize(channels() * count);
    const std::vector<Block> blocks = blocksOf(count);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        const Block& block = blocks[b];
        Matrix z(static_cast<Eigen::Index>(block.size), static_cast<Eigen::Index>(columns.count()));
        for (std::size_t c = 0; c < channels(); ++c) {
            if (c < all.size()) all[c].fill(block.begin, block.size, z.data());
            std::vector<double> linear;
            for (std::size_t i = 0; i < terms; ++i)
                linear.push_back(x[shapes + i * channels() + c]);
            const Matrix rows = jacobianOf(sum_, columns, z, linear);
            for (std::size_t k = 0; k < block.size; ++k) {
                const auto row = static_cast<Eigen::Index>(k);
                const std::size_t at = block.begin + k, place = c * count + at;
                double f = z(row, 0);
                for (std::size_t i = 0; i < terms; ++i)
                    f += linear[i] * z(row, static_cast<Eigen::Index>(1 + i));
                const double cosine = samples_.wiZ[at], root = std::sqrt(samples_.weight(c, at));
                const Mapped mapped = mapValue(loss_, f, cosine);
                result.values[place] = f;
                result.residuals[place] = root * (mapped_[place] - mapped.value);
                for (std::size_t i = 0; i < result.columns; ++i)
                    result.slopes[place * result.columns + i] =
                        root * mapped.slope * rows(row, static_cast<Eigen::Index>(i));
            }
        }
    });
    return result;
}

std::vector<double> FitProblem::values(std::span<const double> x) const {
    const std::size_t shapes = shapeCount(), terms = sum_.linears().size();
    const std::vector<ColumnBlocks> all = columnsAt(x.first(shapes), false, x.subspan(shapes));
    const std::size_t count = samples_.size();
    std::vector<double> result(channels() * count);
    const std::vector<Block> blocks = blocksOf(count);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        const Block& block = blocks[b];
        std::vector<double> z(all[0].count() * block.size);
        for (std::size_t c = 0; c < channels(); ++c) {
            if (c < all.size()) all[c].fill(block.begin, block.size, z.data());
            for (std::size_t k = 0; k < block.size; ++k) {
                double f = z[k];
                for (std::size_t i = 0; i < terms; ++i)
                    f += x[shapes + i * channels() + c] * z[(1 + i) * block.size + k];
                result[c * count + block.begin + k] = f;
            }
        }
    });
    return result;
}

std::vector<double> FitProblem::residuals(std::span<const double> x) const {
    std::vector<double> result = values(x);
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            double& r = result[c * samples_.size() + k];
            r = mapValue(loss_, r, samples_.wiZ[k]).value - mapped_[c * samples_.size() + k];
        }
    return result;
}

}  // namespace hshfit::brdfs
