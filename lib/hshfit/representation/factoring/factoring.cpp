#include <hshfit/representation/factoring/factoring.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/change.h>
#include <hshfit/representation/constraints/constraints_cone.h>
#include <hshfit/representation/factoring/internal/factoring_steps.h>
#include <hshfit/representation/factoring_blocks.h>
#include <hshfit/representation/hemisphere_gram.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline factoring {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Index = Eigen::Index;

Eigen::Map<const Matrix> mapped(const std::vector<double>& values, std::size_t columns) {
    const auto n = static_cast<Index>(columns);
    return {values.data(), static_cast<Index>(values.size()) / n, n};
}

StoredArray stored(const Matrix& values) {
    StoredArray array{
        .shape = {static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols())},
        .values = {}};
    array.values.assign(values.data(), values.data() + values.size());
    return array;
}

/// The least rank that leaves no more than `error` of the norm.
Index rankFor(const Eigen::VectorXd& sigma, double error) {
    double tail = 0;
    const double allowed = error * error * sigma.squaredNorm();
    Index rank = sigma.size();
    while (rank > 1 && tail + sigma(rank - 1) * sigma(rank - 1) <= allowed) {
        tail += sigma(rank - 1) * sigma(rank - 1);
        --rank;
    }
    return rank;
}

WeightedRows rowsOf(const Representation& representation) {
    const Coefficients all = decoded(representation);
    WeightedRows rows{.rows = all.outgoing.size() * all.channels.count(),
                      .slots = all.slots(),
                      .coefficients = all.values,
                      .solidAngles = {}};
    for (double angle : all.outgoing.solidAngles) {
        rows.solidAngles.insert(rows.solidAngles.end(), all.channels.count(), angle);
    }
    return rows;
}

RowFactors singularFactors(const WeightedRows& rows, const Basis& basis,
                           const FactorOptions& options) {
    const HemisphereGram gram(basis);
    std::vector<double> white = rows.coefficients;
    if (!gram.identity()) {
        for (std::size_t r = 0; r < rows.rows; ++r) gram.whiten(white.data() + r * rows.slots);
    }
    const Matrix values = mapped(rows.coefficients, rows.slots);
    const Matrix whitened = mapped(white, rows.slots);
    const Eigen::VectorXd roots =
        Eigen::Map<const Eigen::VectorXd>(rows.solidAngles.data(), whitened.rows()).cwiseSqrt();
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(roots.asDiagonal() * whitened,
                                             Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& sigma = svd.singularValues();
    // Singular values that are rounding errors would only blow up the left part.
    const Index numerical = std::max<Index>((sigma.array() > 1e-14 * sigma(0)).count(), 1);
    const Index wanted = options.rank > 0 ? options.rank : rankFor(sigma, options.error);
    const Index rank = std::min(wanted, numerical);
    // No inverse of the Gram matrix: the right part is a combination of the rows themselves.
    const Matrix right = svd.matrixU().leftCols(rank).transpose() * (roots.asDiagonal() * values);
    const Eigen::VectorXd inverse =
        (sigma.head(rank).array() > 0).select(sigma.head(rank).cwiseInverse(), 0.0);
    const Matrix left = whitened * svd.matrixV().leftCols(rank) * inverse.asDiagonal();
    RowFactors factors{.rank = static_cast<std::size_t>(rank), .left = {}, .right = {}};
    factors.left.assign(left.data(), left.data() + left.size());
    factors.right.assign(right.data(), right.data() + right.size());
    return factors;
}

Representation factoredRows(Representation result, const FactorOptions& options, bool& settled) {
    const auto basis = bases::make(result.head.basis, result.head.order,
                                   {.condonShortley = result.head.condonShortley});
    const WeightedRows rows = rowsOf(result);
    const RowFactors factors =
        options.nonNegative
            ? nonNegativeFactors(rows, *basis, static_cast<std::size_t>(options.rank),
                                 withoutSines(result.slots), options.mostSweeps)
            : singularFactors(rows, *basis, options);
    settled = factors.settled;
    Matrix right(static_cast<Index>(factors.rank), static_cast<Index>(result.slots.size()));
    for (Index r = 0; r < right.rows(); ++r) {
        for (Index k = 0; k < right.cols(); ++k) {
            right(r, k) =
                factors.right[static_cast<std::size_t>(r) * rows.slots +
                              static_cast<std::size_t>(result.slots[static_cast<std::size_t>(k)])];
        }
    }
    result.content = CoefficientFactors{.left = stored(mapped(factors.left, factors.rank)),
                                        .right = stored(right)};
    return result;
}

/// One block with all channels, decomposed; `lost(r)` is the squared norm that rank r leaves out.
class FactoredBlock {
public:
    FactoredBlock(const TermBlock& block, const Representation& matrix, std::size_t terms)
        : block_(block), channels_(static_cast<Index>(matrix.head.channels.count())) {
        const std::vector<double>& values = std::get<MatrixArray>(matrix.content).matrix.values;
        const auto rows = static_cast<Index>(block.rows.size());
        const auto columns = static_cast<Index>(block.columns.size());
        dense_ = Matrix::Zero(channels_ * rows, columns);
        for (Index c = 0; c < channels_; ++c) {
            const double* of = values.data() + static_cast<std::size_t>(c) * terms;
            for (const TermBlock::Entry& e : block.entries) {
                dense_(c * rows + static_cast<Index>(e.row), static_cast<Index>(e.column)) +=
                    e.scale * of[e.term];
            }
            for (std::size_t i = 0; i < block.entries.size(); ++i) {
                const std::size_t term = block.entries[i].term;
                if (i == 0 || block.entries[i - 1].term != term) whole_.push_back(of[term]);
            }
        }
        svd_.compute(dense_, Eigen::ComputeThinU | Eigen::ComputeThinV);
        lost_.push_back(dense_.squaredNorm());
        for (Index r = 1; r <= svd_.singularValues().size(); ++r) lost_.push_back(lostAt(r));
    }

    bool factors() const { return !block_.antisymmetric; }
    Index mostRank() const { return svd_.singularValues().size(); }
    double lost(Index rank) const { return lost_[static_cast<std::size_t>(rank)]; }

    MatrixBlock at(Index rank) const {
        const Index size = numbersAt(rank);
        const auto entries = static_cast<Index>(whole_.size());
        if (!factors() || size >= entries) {
            const std::size_t terms = whole_.size() / static_cast<std::size_t>(channels_);
            return {block_.name, WholeBlock{stored(mapped(whole_, terms))}};
        }
        const Matrix right = svd_.matrixV().leftCols(rank).transpose();
        if (block_.symmetric) {
            return {block_.name,
                    SymmetricBlock{.core = stored(cores(rank)), .right = stored(right)}};
        }
        const Eigen::VectorXd sigma = svd_.singularValues().head(rank);
        return {block_.name, ProductBlock{.left = stored(svd_.matrixU().leftCols(rank)),
                                          .right = stored(sigma.asDiagonal() * right)}};
    }

private:
    Index numbersAt(Index rank) const {
        const Index left =
            block_.symmetric ? channels_ * rank * (rank + 1) / 2 : rank * dense_.rows();
        return left + rank * dense_.cols();
    }
    Matrix coreOf(Index channel, Index rank) const {
        const Index rows = dense_.rows() / channels_;
        const auto v = svd_.matrixV().leftCols(rank);
        return v.transpose() * dense_.middleRows(channel * rows, rows) * v;
    }
    Matrix cores(Index rank) const {
        Matrix result(channels_, rank * (rank + 1) / 2);
        for (Index c = 0; c < channels_; ++c) {
            const Matrix core = coreOf(c, rank);
            for (Index r = 0, at = 0; r < rank; ++r) {
                for (Index s = 0; s <= r; ++s) result(c, at++) = core(r, s);
            }
        }
        return result;
    }
    double lostAt(Index rank) const {
        if (!block_.symmetric) {
            return svd_.singularValues().tail(mostRank() - rank).squaredNorm();
        }
        double kept = 0;
        for (Index c = 0; c < channels_; ++c) kept += coreOf(c, rank).squaredNorm();
        return std::max(dense_.squaredNorm() - kept, 0.0);
    }

    const TermBlock& block_;
    Index channels_;
    Matrix dense_;               ///< [channel, row][column]
    std::vector<double> whole_;  ///< [channel][term of the block]
    Eigen::BDCSVD<Eigen::MatrixXd> svd_;
    std::vector<double> lost_;  ///< [rank]
};

/// Ranks per block: `rank` for all, or lowered one by one where that costs least, while all of
/// them together keep to the error.
std::vector<Index> ranksOf(const std::vector<FactoredBlock>& blocks, const FactorOptions& options) {
    std::vector<Index> ranks;
    double total = 0, lost = 0;
    for (const FactoredBlock& block : blocks) {
        total += block.lost(0);
        ranks.push_back(options.rank > 0 ? std::min<Index>(options.rank, block.mostRank())
                                         : block.mostRank());
    }
    if (options.rank > 0) return ranks;
    for (;;) {
        std::size_t cheapest = blocks.size();
        double least = options.error * options.error * total - lost;
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            if (!blocks[b].factors() || ranks[b] == 0) continue;
            const double more = blocks[b].lost(ranks[b] - 1) - blocks[b].lost(ranks[b]);
            if (more <= least) least = more, cheapest = b;
        }
        if (cheapest == blocks.size()) return ranks;
        lost += std::max(least, 0.0);
        --ranks[cheapest];
    }
}

Representation factoredMatrix(Representation result, const FactorOptions& options) {
    const CoefficientHead& head = result.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    const std::vector<ProductTerm> terms = productTerms(*basis, symmetryOf(result));
    const std::vector<TermBlock> parts = termBlocks(terms, symmetryOf(result));
    std::vector<FactoredBlock> blocks;
    for (const TermBlock& part : parts) blocks.emplace_back(part, result, terms.size());
    const std::vector<Index> ranks = ranksOf(blocks, options);
    MatrixFactors factors;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        factors.blocks.push_back(blocks[b].at(ranks[b]));
    }
    result.content = std::move(factors);
    return result;
}

void check(const Representation& representation, const FactorOptions& options) {
    if (!representation.as<CoefficientArray>() && !representation.as<MatrixArray>()) {
        throw UsageError(
            "only coefficients of the forms outgoing and basis, not yet factored, can be "
            "factored");
    }
    if (options.rank < 0 || (options.rank == 0 && !(options.error > 0))) {
        throw UsageError("factors need a rank of at least 1 or a relative change above 0");
    }
    if (!options.nonNegative) return;
    if (options.rank == 0) throw UsageError("non-negative factors need a rank");
    if (representation.kind() != Representation::Kind::outgoing) {
        throw UsageError("non-negative factors are for the form outgoing");
    }
}

}  // namespace

Representation factored(Representation representation, const FactorOptions& options) {
    check(representation, options);
    const Representation before = representation;
    bool settled = true;
    Representation result = representation.as<CoefficientArray>()
                                ? factoredRows(std::move(representation), options, settled)
                                : factoredMatrix(std::move(representation), options);
    std::string name = options.nonNegative ? "non-negative rank" : "rank";
    name += options.rank > 0 ? fmt::format(" {}", options.rank)
                             : fmt::format(" for {:g}", options.error);
    if (!settled) name += fmt::format(", not settled in {} sweeps", options.mostSweeps);
    addStep(result, before, name);
    return result;
}

}  // namespace hshfit::inline representation::inline factoring
