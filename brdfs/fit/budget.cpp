#include <brdfs/fit/budget.h>

#include <brdfs/fit/distributions.h>

#include <cmath>

namespace hshfit::brdfs {

void combine(ParameterBudget& budget) {
    double variance = 0, fourths = 0;
    for (BudgetRow& row : budget.rows) {
        row.contribution = std::abs(row.sensitivity) * row.standard;
        const double square = row.contribution * row.contribution;
        variance += square;
        fourths += square * square / row.degrees;
    }
    for (BudgetRow& row : budget.rows)
        row.share = variance > 0 ? row.contribution * row.contribution / variance : 0;
    budget.combined = std::sqrt(variance);
    budget.degrees =
        fourths > 0 ? variance * variance / fourths : std::numeric_limits<double>::infinity();
    budget.coverage = studentBound(1 - Budget::probability, budget.degrees);
    budget.expanded = budget.coverage * budget.combined;
}

}  // namespace hshfit::brdfs
