#pragma once

#include <hshfit/bases/basis.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::bases {

/// The curves of a basis in reports. Colours after Okabe & Ito (2008), told apart with colour-blind
/// eyes and on white and black; dashes and marks, of gnuplot, tell the bases apart in grey too.
struct Style {
    const char* colour;
    int dash, mark;
};

/// One row of the table of bases.
struct Entry {
    std::string_view name;    ///< as on the command line
    std::string_view help;    ///< one line
    std::string_view source;  ///< where the definition was published
    int maxOrder;             ///< 2801; less for a finite set or a costly solve
    bool orthonormal;         ///< in the inner product that the basis names
    bool nested;              ///< the coefficients of order n + 1 begin with the ones of order n
    Style style;
    std::unique_ptr<Basis> (*make)(int order, BasisOptions options);
    /// Theta parts of order n are polynomials in mu of degrees below this times n, times roots.
    int degreesPerOrder = 1;
};

/// The table, in the order in which listings and reports show it.
std::span<const Entry> catalog();

/// Throws UsageError naming the known ones if `name` is not in the table.
const Entry& find(std::string_view name);

/// Throws UsageError if the name is unknown or the order is outside 1 .. maxOrder.
std::unique_ptr<Basis> make(std::string_view name, int order, BasisOptions options = {});

/// The highest degree in mu of the polynomials in the theta parts of `basis`, roots left out.
/// Throws UsageError for a basis that is not in the table.
int highestDegree(const Basis& basis);

/// "all" or a comma-separated list of names, as rows of the table.
std::vector<const Entry*> select(std::string_view names);

}  // namespace hshfit::bases
