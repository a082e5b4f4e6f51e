#pragma once

#include <cstddef>
#include <limits>

namespace hshfit::inline projection {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// The last changes of a quantity from level to level, newest first; infinite before there are any.
/// Levels grow by a factor of 1.4 in both directions.
struct Changes {
    static constexpr std::size_t kept = 3;
    double values[kept] = {infinity, infinity, infinity};

    void add(double change) {
        values[2] = values[1];
        values[1] = values[0];
        values[0] = change;
    }
};

/// Errors that follow from a panel's changes, both relative.
struct PanelError {
    double expected = 0;  ///< decides about refinement
    double stated = 0;    ///< not below `expected`
};

/// The error of the newest level, from changes of which each is the largest over all quantities,
/// each relative to its size: one alone may agree by accident where f has kinks, and square or
/// moment converge at different levels.
///
/// Exponential convergence gains more with every level: then the next change is at most the last
/// one times its ratio to the one before. Otherwise changes go down by a ratio q of 0.4 to 0.7 with
/// accidents, and the error is about the last change times q / (1 - q), or what is left of an
/// earlier change that was larger. A last change of less than 3 % of the one that the two before
/// lead to is raised to that. `mayBeSmooth`: whether the first is possible at all. If not, as with
/// interpolated tables, whose next level costs more than all before it, refinement goes by the last
/// change alone, and three times that error is stated, ten times where there is one change.
/// Factors from trials over tables of all formats (docs/results/stability.md).
PanelError panelError(const Changes& changes, bool mayBeSmooth);

/// The error of a panel that has shown one or two changes and is asked for a loose tolerance: three
/// times a change that is the only one, and the error of algebraic convergence for two. For a
/// smooth f this overstates the error by far, which leaves room for accidents.
PanelError earlyError(const Changes& changes);

}  // namespace hshfit::inline projection
