#include <hshfit/bases/internal/step_rows.h>

#include <hshfit/bases/internal/long_orders.h>

#include <algorithm>

namespace hshfit::bases::kernels {

template <class Real>
StepRows<Real>::StepRows(const Recurrences<double>& steps, std::size_t side) {
    const auto order = static_cast<std::size_t>(steps.order);
    const auto apart = static_cast<std::size_t>(steps.bandStep);
    std::size_t total = 0;
    for (std::size_t m0 = 0; m0 < order; m0 += columns) {
        widths_.push_back(std::min(columns, (order - m0 + group - 1) / group * group));
        offsets_.push_back(total);
        total += 3 * widths_.back() / perLine * ((order - m0 + apart - 1) / apart);
    }
    lines_.resize(total);
    for (std::size_t b = 0; b < blocks(); ++b) {
        const std::size_t m0 = b * columns, wide = widths_[b];
        Real* row = lines_[offsets_[b]].value.data();
        for (std::size_t l = m0; l < order; l += apart, row += 3 * wide)
            for (std::size_t m = m0; m < m0 + wide; ++m) {
                // The one of rows l and l + 1 in which column m has a function.
                const std::size_t target = l + (l + m) % apart;
                const bool moves = m < target && target < order;
                Step<double> step{0, 1, 0};
                if (moves) step = steps.steps[side][steps.offsets[m] + (target - m) / apart - 1];
                row[m - m0] = static_cast<Real>(step.slope);
                row[wide + m - m0] = static_cast<Real>(step.ratio);
                row[2 * wide + m - m0] = static_cast<Real>(step.carry);
            }
    }
}

template class StepRows<double>;
template class StepRows<float>;

}  // namespace hshfit::bases::kernels
