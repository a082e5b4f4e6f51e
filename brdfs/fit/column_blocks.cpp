#include <brdfs/fit/column_blocks.h>

#include <brdfs/fit/column_products.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

bool same(const Direction& a, const Direction& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Columns at pairs, one call for each run of pairs with one outgoing direction.
void evalRuns(const PairPlaces& pairs, const Columns& columns, double* out) {
    double buffer[64 * 8];
    const std::size_t most = std::max<std::size_t>(1, std::size(buffer) / columns.count());
    for (std::size_t k = 0; k < pairs.count;) {
        std::size_t run = 1;
        while (k + run < pairs.count && run < most && same(pairs.wo[k + run], pairs.wo[k])) ++run;
        columns.eval(pairs.wo[k], {pairs.x + k, pairs.y + k, pairs.z + k, run}, buffer);
        for (std::size_t c = 0; c < columns.count(); ++c)
            std::copy_n(buffer + c * run, run, out + c * pairs.count + k);
        k += run;
    }
}

}  // namespace

ColumnBlocks::ColumnBlocks(const FitSamples& samples, const ParametricSum& sum,
                           std::span<const double> u, bool derivatives, std::size_t channel,
                           std::vector<double> linears)
    : samples_(samples), linears_(std::move(linears)), count_(1 + sum.linears().size()) {
    const std::vector<ShapeParameter>& shapes = sum.shapes();
    std::vector<double> values;
    for (std::size_t j = 0; j < shapes.size(); ++j) values.push_back(shapes[j].toValue(u[j]));
    std::size_t firstLinear = 1;
    for (std::size_t t = 0; t < sum.termCount(); ++t) {
        Term term;
        term.channelwise = sum.channelwise(t);
        term.formula = term.channelwise
                           ? sum.channelColumns(t, channel, values, linears_, derivatives)
                           : sum.formulaColumns(t, values, derivatives);
        term.linears = sum.linearsOfTerm(t).size();
        term.firstLinear = firstLinear;
        term.firstSlope = count_;
        firstLinear += term.linears;
        if (!term.formula) term.columns = sum.columnsOf(t, values);
        for (const std::size_t j : sum.shapesOfTerm(t)) {
            if (!derivatives) continue;
            term.slopes.push_back(shapes[j].slope(values[j]));
            first_.push_back(count_);
            count_ += 1 + term.linears;
            if (term.formula) continue;
            // One-sided at a bound.
            const double low = std::max(u[j] - shapes[j].step(), shapes[j].lower());
            const double high = std::min(u[j] + shapes[j].step(), shapes[j].upper());
            const auto at = [&](double moved) {
                std::vector<double> changed = values;
                changed[j] = shapes[j].toValue(moved);
                return sum.columnsOf(t, changed);
            };
            term.differences.push_back(
                {.above = at(high), .below = at(low), .inverse = 1 / (high - low)});
        }
        terms_.push_back(std::move(term));
    }
}

void ColumnBlocks::fill(std::size_t begin, std::size_t size, double* out) const {
    if (samples_.sums) return fillSums(begin, size, out);
    fillPairs({samples_.wiX.data() + begin, samples_.wiY.data() + begin,
               samples_.wiZ.data() + begin, samples_.wo.data() + begin, size},
              out);
}

void ColumnBlocks::fillPairs(const PairPlaces& pairs, double* out) const {
    std::fill_n(out, pairs.count, 0.0);
    for (const Term& term : terms_) {
        if (term.channelwise)
            fillLinearised(term, pairs, out);
        else if (term.formula)
            fillByFormula(term, pairs, out);
        else
            fillByDifferences(term, pairs, out);
    }
}

// Node by node in blocks; sums over the same nodes are a product of matrices.
void ColumnBlocks::fillSums(std::size_t begin, std::size_t size, double* out) const {
    const NodeSums& sums = *samples_.sums;
    std::fill_n(out, size * count_, 0.0);
    const auto rowOf = [&](std::size_t k) -> const NodeSums::Row& {
        return sums.rows[samples_.sumRows[begin + k]];
    };
    std::vector<double> columns(blockSize * count_);
    for (std::size_t k = 0; k < size;) {
        // Samples whose nodes fit into one block, or the samples of one range of nodes.
        const std::size_t first = rowOf(k).firstNode;
        std::size_t next = k + 1, last = first + rowOf(k).nodes;
        while (next < size && (rowOf(next).firstNode == rowOf(next - 1).firstNode ||
                               rowOf(next).firstNode + rowOf(next).nodes <= first + blockSize)) {
            last = rowOf(next).firstNode + rowOf(next).nodes;
            ++next;
        }
        for (std::size_t node = first; node < last; node += blockSize) {
            const std::size_t count = std::min(blockSize, last - node);
            fillPairs({sums.wiX.data() + node, sums.wiY.data() + node, sums.wiZ.data() + node,
                       sums.wo.data() + node, count},
                      columns.data());
            for (std::size_t s = k; s < next;) {
                const NodeSums::Row& row = rowOf(s);
                // Sums over the same nodes, whose factors follow one another.
                std::size_t end = s + 1;
                while (end < next && rowOf(end).firstNode == row.firstNode &&
                       rowOf(end).firstFactor == row.firstFactor + (end - s) * row.nodes)
                    ++end;
                const std::size_t from = std::max(row.firstNode, node),
                                  to = std::min(row.firstNode + row.nodes, node + count);
                if (from < to) {
                    const ColumnSpan factors{
                        sums.factors.data() + row.firstFactor + (from - row.firstNode), end - s,
                        row.nodes};
                    const ColumnSpan values{columns.data() + (from - node), count_, count};
                    addProducts(factors, values, to - from, out + s, size);
                }
                s = end;
            }
        }
        k = next;
    }
}

void ColumnBlocks::fillByFormula(const Term& term, const PairPlaces& pairs, double* out) const {
    const std::size_t size = pairs.count;
    double* slopes = out + term.firstSlope * size;
    const PairBatch batch{.wi = {pairs.x, pairs.y, pairs.z, size}, .wo = pairs.wo};
    term.formula->fill(batch, out, out + term.firstLinear * size, slopes);
    const std::size_t rows = (1 + term.linears) * size;
    for (std::size_t j = 0; j < term.slopes.size(); ++j)
        for (std::size_t k = 0; k < rows; ++k) slopes[j * rows + k] *= term.slopes[j];
}

void ColumnBlocks::fillLinearised(const Term& term, const PairPlaces& pairs, double* out) const {
    const std::size_t size = pairs.count, shapes = term.slopes.size(), rows = 1 + term.linears;
    std::vector<double> f(size, 0.0), slopes((shapes + term.linears) * size);
    term.formula->fill({.wi = {pairs.x, pairs.y, pairs.z, size}, .wo = pairs.wo}, f.data(), nullptr,
                       slopes.data());
    for (std::size_t j = 0; j < shapes; ++j) {
        double* to = out + (term.firstSlope + j * rows) * size;
        for (std::size_t k = 0; k < size; ++k) to[k] = term.slopes[j] * slopes[j * size + k];
        std::fill_n(to + size, term.linears * size, 0.0);
    }
    for (std::size_t i = 0; i < term.linears; ++i) {
        const double* slope = slopes.data() + (shapes + i) * size;
        const double about = linears_[term.firstLinear - 1 + i];
        std::copy_n(slope, size, out + (term.firstLinear + i) * size);
        for (std::size_t k = 0; k < size; ++k) f[k] -= about * slope[k];
    }
    for (std::size_t k = 0; k < size; ++k) out[k] += f[k];
}

void ColumnBlocks::fillByDifferences(const Term& term, const PairPlaces& pairs, double* out) const {
    const std::size_t size = pairs.count;
    std::vector<double> own(term.columns.count() * size);
    evalRuns(pairs, term.columns, own.data());
    for (std::size_t k = 0; k < size; ++k) out[k] += own[k];
    std::copy(own.begin() + static_cast<std::ptrdiff_t>(size), own.end(),
              out + term.firstLinear * size);
    for (std::size_t j = 0; j < term.differences.size(); ++j) {
        const Difference& difference = term.differences[j];
        double* to = out + (term.firstSlope + j * (1 + term.linears)) * size;
        evalRuns(pairs, difference.above, to);
        evalRuns(pairs, difference.below, own.data());
        for (std::size_t k = 0; k < own.size(); ++k) to[k] = (to[k] - own[k]) * difference.inverse;
    }
}

}  // namespace hshfit::brdfs
