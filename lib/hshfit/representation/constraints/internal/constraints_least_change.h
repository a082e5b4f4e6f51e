#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline representation::inline constraints {

/// min |x - start|^2 subject to row_k . x >= bound_k, by the dual active-set method of Goldfarb &
/// Idnani (1983) with the identity as its matrix: from the unconstrained minimum, the most violated
/// constraint is taken in at a time, and constraints whose multiplier would change its sign are let
/// go. The normals of the active set are kept as a QR decomposition that is updated. Constraints
/// may be added between solves, which go on from where they were.
class LeastChange {
public:
    explicit LeastChange(std::vector<double> start);
    ~LeastChange();
    LeastChange(LeastChange&&) noexcept;

    /// Rows are scaled to norm 1; one of norm 0 is ignored.
    void add(std::span<const double> row, double bound);
    /// Until every scaled constraint is kept to `tolerance` (absolute). Constraints that contradict
    /// the others within rounding are left out. Throws NumericError if it does not end.
    void solve(double tolerance);
    const std::vector<double>& x() const;
    std::size_t active() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace hshfit::inline representation::inline constraints
