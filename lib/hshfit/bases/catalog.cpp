#include <hshfit/bases/catalog.h>

#include <hshfit/bases/internal/h_basis.h>
#include <hshfit/bases/internal/hsh.h>
#include <hshfit/bases/internal/makhotkin.h>
#include <hshfit/bases/internal/slepian.h>
#include <hshfit/bases/internal/zernike.h>
#include <hshfit/bases/lsosh.h>
#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/spelling.h>

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace hshfit::bases {

namespace {

/// Degree 2800 is the highest at which values were compared with 100 digits (bases_kernels_test).
/// The recurrence's tables grow as the square and take 190 MB there.
constexpr int jacobiOrders = 2801;

constexpr std::array table{
    Entry{"hsh",
          "hemispherical harmonics: Legendre functions of 2 cos(theta) - 1",
          "Gautron et al. 2004",
          jacobiOrders,
          true,
          true,
          {"#0072B2", 1, 7},
          makeHsh},
    Entry{"sh",
          "spherical harmonics, the function being 0 below the horizon",
          "Laplace 1782; Schönefeld 2005",
          jacobiOrders,
          true,
          true,
          {"#E69F00", 2, 5},
          makeSh},
    Entry{"esh",
          "even spherical harmonics, the function being mirrored at the horizon",
          "compared in Gautron et al. 2004",
          jacobiOrders,
          true,
          true,
          {"#D55E00", 4, 9},
          makeEsh},
    Entry{"lsosh",
          "spherical harmonics fitted by least squares on the hemisphere only",
          "Sloan et al. 2003",
          100,
          false,
          false,
          {"#9A6A4F", 5, 11},
          makeLsosh},
    Entry{"zernike",
          "Zernike polynomials on the disc of radius sqrt(2) sin(theta/2)",
          "Koenderink et al. 1996",
          jacobiOrders,
          true,
          true,
          {"#009E73", 1, 13},
          makeZernike},
    Entry{"makhotkin",
          "associated Jacobi polynomials times sqrt(cos(theta)); reconstructed",
          "after Makhotkin 1996, not consulted",
          jacobiOrders,
          true,
          true,
          {"#CC79A7", 2, 6},
          makeMakhotkin},
    Entry{"makhotkin-flux",
          "the same for the weight cos(theta): one function carries all flux",
          "after Makhotkin 1996, not consulted",
          jacobiOrders,
          true,
          true,
          {"#8A63C9", 4, 4},
          makeMakhotkinFlux},
    Entry{"h-basis",
          "six functions for irradiance; orders 1 to 3",
          "Habel & Wimmer 2010",
          3,
          true,
          true,
          {"#56B4E9", 1, 8},
          makeHBasis},
    Entry{"slepian",
          "spherical harmonics of twice the order, best concentrated on the hemisphere",
          "Simons, Dahlen & Wieczorek 2006",
          100,
          true,
          false,
          {"#4D4D4D", 3, 10},
          makeSlepian,
          2},
};

}  // namespace

std::span<const Entry> catalog() {
    return table;
}

const Entry& find(std::string_view name) {
    const auto* row = std::find_if(table.begin(), table.end(),
                                   [&](const Entry& entry) { return entry.name == name; });
    if (row == table.end()) throw spelling::unknown("basis", name, spelling::namesOf(table));
    return *row;
}

std::unique_ptr<Basis> make(std::string_view name, int order, BasisOptions options) {
    const Entry& entry = find(name);
    if (order < 1 || order > entry.maxOrder)
        throw UsageError(fmt::format("order {} of basis '{}' is outside 1 .. {}", order, entry.name,
                                     entry.maxOrder));
    return entry.make(order, options);
}

int highestDegree(const Basis& basis) {
    return find(basis.name()).degreesPerOrder * basis.order() - 1;
}

std::vector<const Entry*> select(std::string_view names) {
    std::vector<const Entry*> rows;
    const auto add = [&](const Entry& entry) {
        if (std::find(rows.begin(), rows.end(), &entry) == rows.end()) rows.push_back(&entry);
    };
    if (names == "all") {
        for (const Entry& entry : table) add(entry);
        return rows;
    }
    for (std::size_t first = 0; first <= names.size();) {
        const std::size_t last = std::min(names.find(',', first), names.size());
        add(find(names.substr(first, last - first)));
        first = last + 1;
    }
    return rows;
}

}  // namespace hshfit::bases
