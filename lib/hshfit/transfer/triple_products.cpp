#include <hshfit/transfer/triple_products.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/transfer/internal/ring_transform.h>
#include <hshfit/transfer/wigner.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

namespace hshfit::inline transfer {
namespace {

/// The bands and m >= 0 of three functions: m of the third is the sum of the others.
struct Columns {
    int a, b;
    int c() const { return a + b; }
};

/// Whether (la, lb, lc) is the one order in which this set of functions is visited.
bool visited(const Columns& m, int la, int lb, int lc) {
    if (m.a == m.b && la > lb) return false;
    return m.a > 0 || lb <= lc;  // a = 0: b = c
}

/// Calls take(i, j, k, factor) for each choice of signs of the m that is not 0: the entry is the
/// theta integral times the factor.
template <class Take>
void eachSign(const Columns& m, int la, int lb, int lc, Take&& take) {
    const auto add = [&](int a, int b, int c) {
        take(slotOf(la, a), slotOf(lb, b), slotOf(lc, c), azimuthProduct(a, b, c));
    };
    add(m.a, m.b, m.c());
    if (m.b > 0) add(m.a, -m.b, -m.c());
    if (m.a > 0) {
        // With equal columns this is the one before once more.
        if (m.a != m.b || la != lb) add(-m.a, m.b, -m.c());
        add(-m.a, -m.b, m.c());
    }
}

template <class Visit>
void eachColumns(int order, Visit&& visit) {
    for (int a = 0; a < order; ++a) {
        for (int b = a; a + b < order; ++b) visit(Columns{a, b});
    }
}

bool isSphere(const Basis& basis) {
    return basis.name() == "sh";
}

/// Gaunt coefficients: take(columns, la, lb, lc, theta integral) with
///     sqrt((2 la + 1)(2 lb + 1)(2 lc + 1) / 2) (la lb lc; 0 0 0) (la lb lc; a b -c) (-1)^c.
template <class Take>
void eachGaunt(int order, Take&& take) {
    WignerFamily flat, family;
    for (int lb = 0; lb < order; ++lb) {
        for (int lc = 0; lc < order; ++lc) {
            flat.compute(lb, lc, 0, 0);
            for (int c = 0; c <= lc; ++c) {
                for (int b = (c + 1) / 2; b <= std::min(c, lb); ++b) {
                    const Columns m{c - b, b};
                    family.compute(lb, lc, b, -c);
                    const int last = std::min(lb + lc, order - 1);
                    int la = std::max(family.first, m.a);
                    la += (la + lb + lc) % 2;
                    for (; la <= last; la += 2) {
                        if (!visited(m, la, lb, lc)) continue;
                        const double scale =
                            std::sqrt((2.0 * la + 1) * (lb + 0.5) * (2.0 * lc + 1));
                        take(m, la, lb, lc,
                             (c % 2 == 0 ? scale : -scale) *
                                 flat.values[static_cast<std::size_t>(la - flat.first)] *
                                 family.values[static_cast<std::size_t>(la - family.first)]);
                    }
                }
            }
        }
    }
}

/// The same by quadrature.
template <class Take>
void eachIntegral(const Basis& basis, Take&& take) {
    const int order = basis.order();
    const RingGrid grid = RingGrid::exactFor(basis, 3 * bases::highestDegree(basis), 0);
    const std::size_t rings = grid.elevations.size();
    std::vector<std::vector<double>> theta;
    for (int m = 0; m < order; ++m) {
        theta.emplace_back(rings * static_cast<std::size_t>(order - m));
        basis.theta(m, grid.elevations, theta.back().data());
    }
    const auto row = [&](int m, int l) {
        return theta[static_cast<std::size_t>(m)].data() + static_cast<std::size_t>(l - m) * rings;
    };
    std::vector<double> product(rings);
    eachColumns(order, [&](const Columns& m) {
        for (int la = m.a; la < order; ++la) {
            for (int lb = m.b; lb < order; ++lb) {
                if (!basis.has(la, m.a) || !basis.has(lb, m.b)) continue;
                for (std::size_t r = 0; r < rings; ++r) {
                    product[r] = grid.weights[r] * row(m.a, la)[r] * row(m.b, lb)[r];
                }
                for (int lc = m.c(); lc < order; ++lc) {
                    if (!basis.has(lc, m.c()) || !visited(m, la, lb, lc)) continue;
                    const double* last = row(m.c(), lc);
                    take(m, la, lb, lc,
                         std::inner_product(product.begin(), product.end(), last, 0.0));
                }
            }
        }
    });
}

}  // namespace

std::size_t TripleProducts::count(const Basis& basis, std::size_t most) {
    const int order = basis.order();
    std::size_t entries = 0;
    eachColumns(order, [&](const Columns& m) {
        if (entries > most) return;
        for (int la = m.a; la < order; ++la) {
            for (int lb = m.b; lb < order; ++lb) {
                for (int lc = m.c(); lc < order; ++lc) {
                    if (!visited(m, la, lb, lc)) continue;
                    if (isSphere(basis)) {
                        if ((la + lb + lc) % 2 != 0 || lc > la + lb || lc < std::abs(la - lb))
                            continue;
                    } else if (!basis.has(la, m.a) || !basis.has(lb, m.b) ||
                               !basis.has(lc, m.c())) {
                        continue;
                    }
                    eachSign(m, la, lb, lc, [&](int, int, int, double) { ++entries; });
                }
            }
        }
    });
    return entries;
}

TripleProducts::TripleProducts(const Basis& basis, std::size_t mostEntries)
    : order_(basis.order()) {
    requireOrthonormal(basis);
    const std::size_t entries = count(basis, mostEntries);
    if (entries > mostEntries) {
        throw UsageError(fmt::format(
            "triple products of basis '{}' of order {} are more than {} numbers; a transfer matrix "
            "or a product of two vectors needs no tensor",
            basis.name(), order_, mostEntries));
    }
    entries_.reserve(entries);
    const auto add = [&](const Columns& m, int la, int lb, int lc, double theta) {
        eachSign(m, la, lb, lc, [&](int i, int j, int k, double factor) {
            std::array<int, 3> slots{i, j, k};
            std::sort(slots.begin(), slots.end());
            entries_.push_back({static_cast<std::uint32_t>(slots[0]),
                                static_cast<std::uint32_t>(slots[1]),
                                static_cast<std::uint32_t>(slots[2]), theta * factor});
        });
    };
    if (isSphere(basis)) {
        eachGaunt(order_, add);
    } else {
        eachIntegral(basis, add);
    }
    sort();
}

void TripleProducts::sort() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& one, const Entry& other) {
        return std::array{one.i, one.j, one.k} < std::array{other.i, other.j, other.k};
    });
}

double TripleProducts::at(std::size_t i, std::size_t j, std::size_t k) const {
    std::array<std::uint32_t, 3> slots{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                                       static_cast<std::uint32_t>(k)};
    std::sort(slots.begin(), slots.end());
    const auto found = std::lower_bound(entries_.begin(), entries_.end(), slots,
                                        [](const Entry& entry, const auto& key) {
                                            return std::array{entry.i, entry.j, entry.k} < key;
                                        });
    if (found == entries_.end() || std::array{found->i, found->j, found->k} != slots) return 0;
    return found->value;
}

void TripleProducts::multiply(std::span<const double> a, std::span<const double> b,
                              double* out) const {
    const auto slots = static_cast<std::size_t>(order_) * static_cast<std::size_t>(order_);
    assert(a.size() == slots && b.size() == slots);
    std::fill(out, out + slots, 0.0);
    for (const Entry& e : entries_) {
        const double cross = a[e.i] * b[e.j] + (e.i == e.j ? 0 : a[e.j] * b[e.i]);
        out[e.k] += e.value * cross;
        if (e.j == e.k) {
            // i < j = k: c_i takes a_j a_j once; i = j = k is done.
            if (e.i != e.j) out[e.i] += e.value * a[e.j] * b[e.j];
            continue;
        }
        // j < k: c_j takes the pair (i, k) and, if i < j, c_i takes (j, k).
        out[e.j] += e.value * (a[e.i] * b[e.k] + a[e.k] * b[e.i]);
        if (e.i != e.j) out[e.i] += e.value * (a[e.j] * b[e.k] + a[e.k] * b[e.j]);
    }
}

}  // namespace hshfit::inline transfer
