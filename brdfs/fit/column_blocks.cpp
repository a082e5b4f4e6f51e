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
    : samples_(samples) {
    const std::vector<ShapeParameter>& shapes = sum.shapes();
    std::vector<double> values;
    for (std::size_t j = 0; j < shapes.size(); ++j) values.push_back(shapes[j].toValue(u[j]));
    columns_ = sum.columns(values);
    count_ = columns_.count();
    if (!derivatives) return;
    for (std::size_t j = 0; j < shapes.size(); ++j) {
        // One-sided at a bound.
        const double low = std::max(u[j] - shapes[j].step(), shapes[j].lower());
        const double high = std::min(u[j] + shapes[j].step(), shapes[j].upper());
        const auto at = [&](double moved) {
            std::vector<double> changed = values;
            changed[j] = shapes[j].toValue(moved);
            return sum.columnsOf(shapes[j].term, changed);
        };
        differences_.push_back({.above = at(high), .below = at(low), .inverse = 1 / (high - low)});
        first_.push_back(count_);
        count_ += differences_.back().above.count();
    }
}

void ColumnBlocks::fill(std::size_t begin, std::size_t size, double* out) const {
    evalRuns(samples_, columns_, begin, size, out);
    std::vector<double> below;
    for (std::size_t j = 0; j < differences_.size(); ++j) {
        const Difference& difference = differences_[j];
        double* to = out + first_[j] * size;
        below.resize(difference.below.count() * size);
        evalRuns(samples_, difference.above, begin, size, to);
        evalRuns(samples_, difference.below, begin, size, below.data());
        for (std::size_t k = 0; k < below.size(); ++k)
            to[k] = (to[k] - below[k]) * difference.inverse;
    }
}

}  // namespace hshfit::brdfs
