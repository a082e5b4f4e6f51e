#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/representation/constraints/constraints_scan.h>
#include <hshfit/representation/hemisphere_gram.h>

#include <functional>
#include <memory>
#include <vector>

namespace hshfit::inline representation::inline constraints {

/// Negative values down to this share of the root mean square count as 0.
inline constexpr double nonNegativeTolerance = 1e-5;

/// Sums over a basis that are nowhere negative on the hemisphere, and the nearest of them.
class NonNegativeCone {
public:
    /// A function that is added to the sum before its sign is judged; never negative itself.
    using Added = std::function<double(const Direction& wi)>;
    /// functional . c <= most.
    struct Limit {
        std::vector<double> functional;  ///< in slots
        double most = 0;
    };

    /// `even`: the sums have no sines, before and after. `sure`: look on the finer grid as well,
    /// for minima that the coarse one hides; without, some are missed. `mostRounds`: how often
    /// constraints are added. Throws UsageError for a basis that is not orthonormal with a
    /// condition above 1e9.
    NonNegativeCone(const Basis& basis, bool even, bool sure = true, int mostRounds = 60);

    /// The coefficients nearest to `c` whose sum plus `added` is at least -1e-5 of its root mean
    /// square everywhere, and within the limit, if any. Directions are added as constraints where
    /// the sum is negative, first at local minima, then along the floors of valleys, until none is
    /// found; what the tolerance leaves is lifted by band 0. The last round may leave as much;
    /// throws NumericError where it leaves more.
    std::vector<double> nearest(const double* c, const Added& added = {},
                                const Limit* limit = nullptr) const;

private:
    struct Minimum {
        Direction wi;
        double value;
    };
    std::vector<Minimum> minima(const std::vector<double>& c, const Added& added, double scale,
                                bool thorough) const;
    std::vector<double> row(const Direction& wi) const;

    const Basis& basis_;
    bool even_, sure_;
    int mostRounds_;
    HemisphereScan coarse_, fine_;
    std::unique_ptr<HemisphereGram> gram_;  ///< null: the norm of the coefficients counts
};

/// For a search for non-negative sums that its last round did not end. `least`: of the sum, and of
/// what was lifted, in units of the root mean square. Throws NumericError beyond the tolerance.
void requireNearlySettled(const Basis& basis, int rounds, double least);

/// Whether none of the slots belongs to a sine.
bool withoutSines(const std::vector<int>& slots);

}  // namespace hshfit::inline representation::inline constraints
