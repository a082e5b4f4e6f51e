#include <brdfs/fit/column_blocks.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

bool same(const Direction& a, const Direction& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Columns at samples, one call for each run of samples with one outgoing direction.
void evalRuns(const FitSamples& samples, const Columns& columns, std::size_t begin,
              std::size_t size, double* out) {
    double buffer[64 * 8];
    const std::size_t most = std::max<std::size_t>(1, std::size(buffer) / columns.count());
    for (std::size_t k = 0; k < size;) {
        const std::size_t at = begin + k;
        std::size_t run = 1;
        while (k + run < size && run < most && same(samples.wo[at + run], samples.wo[at])) ++run;
        columns.eval(
            samples.wo[at],
            {samples.wiX.data() + at, samples.wiY.data() + at, samples.wiZ.data() + at, run},
            buffer);
        for (std::size_t c = 0; c < columns.count(); ++c)
            std::copy_n(buffer + c * run, run, out + c * size + k);
        k += run;
    }
}

}  // namespace

ColumnBlocks::ColumnBlocks(const FitSamples& samples, const ParametricSum& sum,
                           std::span<const double> u, bool derivatives)
    : samples_(samples), count_(1 + sum.linears().size()) {
    const std::vector<ShapeParameter>& shapes = sum.shapes();
    std::vector<double> values;
    for (std::size_t j = 0; j < shapes.size(); ++j) values.push_back(shapes[j].toValue(u[j]));
    std::size_t firstLinear = 1;
    for (std::size_t t = 0; t < sum.termCount(); ++t) {
        Term term;
        term.formula = sum.formulaColumns(t, values, derivatives);
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
    std::fill_n(out, size, 0.0);
    for (const Term& term : terms_) {
        if (term.formula)
            fillByFormula(term, begin, size, out);
        else
            fillByDifferences(term, begin, size, out);
    }
}

void ColumnBlocks::fillByFormula(const Term& term, std::size_t begin, std::size_t size,
                                 double* out) const {
    double* slopes = out + term.firstSlope * size;
    const PairBatch pairs{.wi = {samples_.wiX.data() + begin, samples_.wiY.data() + begin,
                                 samples_.wiZ.data() + begin, size},
                          .wo = samples_.wo.data() + begin};
    term.formula->fill(pairs, out, out + term.firstLinear * size, slopes);
    const std::size_t rows = (1 + term.linears) * size;
    for (std::size_t j = 0; j < term.slopes.size(); ++j)
        for (std::size_t k = 0; k < rows; ++k) slopes[j * rows + k] *= term.slopes[j];
}

void ColumnBlocks::fillByDifferences(const Term& term, std::size_t begin, std::size_t size,
                                     double* out) const {
    std::vector<double> own(term.columns.count() * size);
    evalRuns(samples_, term.columns, begin, size, own.data());
    for (std::size_t k = 0; k < size; ++k) out[k] += own[k];
    std::copy(own.begin() + static_cast<std::ptrdiff_t>(size), own.end(),
              out + term.firstLinear * size);
    for (std::size_t j = 0; j < term.differences.size(); ++j) {
        const Difference& difference = term.differences[j];
        double* to = out + (term.firstSlope + j * (1 + term.linears)) * size;
        evalRuns(samples_, difference.above, begin, size, to);
        evalRuns(samples_, difference.below, begin, size, own.data());
        for (std::size_t k = 0; k < own.size(); ++k) to[k] = (to[k] - own[k]) * difference.inverse;
    }
}

}  // namespace hshfit::brdfs
