#pragma once

#include <limits>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// A line of the budget of one parameter (JCGM 100:2008, annex H), ready to be printed.
struct BudgetRow {
    std::string name;
    char type = 'B';           ///< 'A': from the scatter of the samples
    std::string distribution;  ///< "normal", "rectangular", "triangular" or "u-shaped"
    double standard = 0;       ///< standard uncertainty of the quantity, in `unit`
    std::string unit;          ///< "1", "1/sr", "degrees"; empty: the parameter's unit
    double sensitivity = 0;    ///< of the parameter by the quantity, signed
    double contribution = 0;   ///< |sensitivity| standard, in the parameter's unit
    double share = 0;          ///< of the combined variance
    double degrees = std::numeric_limits<double>::infinity();
};

/// The budget of one parameter. Parameters without a standard error have none.
struct ParameterBudget {
    std::string name, channel;
    double value = 0;
    std::vector<BudgetRow> rows;  ///< the samples first, then the contributions as they were stated
    double combined = 0;          ///< root of the sum of squared contributions
    double degrees = std::numeric_limits<double>::infinity();  ///< Welch-Satterthwaite
    double coverage = 0;  ///< k: Student's for Budget::probability and these degrees
    double expanded = 0;  ///< k times combined
};

/// Uncertainties of parameters from what samples scatter and from what is common to all of them.
struct Budget {
    static constexpr double probability = 0.9545;  ///< that an expanded uncertainty holds
    std::vector<ParameterBudget> parameters;
};

/// Sets what follows from the rows: contributions, shares, combined and expanded uncertainty.
void combine(ParameterBudget& budget);

}  // namespace hshfit::brdfs
