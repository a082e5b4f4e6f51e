#include <hshfit/representation/halfway/halfway_terms.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr std::size_t maxTerms = 65536;
constexpr int maxOrder = 256;

/// The degree along the mean goes to 6/5 of an order.
constexpr int mostPolynomials = maxOrder * 6 / 5 + 2;
/// Values of the polynomials of four variables, whose recurrences run side by side: each waits for
/// its own divisions.
using FourValues = std::array<double, 4>;

/// sqrt(2 n + 1), the norm of p_n.
const std::array<double, mostPolynomials>& norms() {
    static const auto table = [] {
        std::array<double, mostPolynomials> values;
        for (int n = 0; n < mostPolynomials; ++n)
            values[static_cast<std::size_t>(n)] = std::sqrt(2.0 * n + 1);
        return values;
    }();
    return table;
}

/// p_0 .. p_{count-1} at each x in [0, 1], by the recurrence of Legendre's polynomials.
void legendre(const FourValues& x, int count, FourValues* out) {
    FourValues t, before{}, now{1, 1, 1, 1};
    for (std::size_t k = 0; k < 4; ++k) t[k] = 2 * x[k] - 1;
    const auto& norm = norms();
    for (int n = 0; n < count; ++n) {
        for (std::size_t k = 0; k < 4; ++k) {
            out[n][k] = norm[static_cast<std::size_t>(n)] * now[k];
            const double next = ((2 * n + 1) * t[k] * now[k] - n * before[k]) / (n + 1);
            before[k] = now[k];
            now[k] = next;
        }
    }
}

bool allowed(const HalfwayTerm& t, const HalfwaySymmetry& symmetry) {
    if (t.sine && t.q == 0) return false;
    if (symmetry.reciprocal && t.exchange != t.mirror) return false;
    if (!symmetry.bilateral) return true;
    return t.q % 2 == 0 && t.mirror == t.sine;
}

int turnsOf(const HalfwayTerm& t, const HalfwaySymmetry& symmetry) {
    return symmetry.bilateral ? t.q / 2 : t.q;
}

/// The degree d of a term with i = 0.
int degreeOf(const HalfwayTerm& t, const HalfwaySymmetry& symmetry) {
    const int turns = turnsOf(t, symmetry);
    return t.lobe ? t.k + t.exchange + t.mirror + turns
                  : 2 * t.k + 3 * t.exchange + 2 * t.mirror + 2 * turns;
}

int smoothAlongV(const HalfwayOrders& orders) {
    return (orders.difference + 1) / 2;
}

/// The number of i that the truncation leaves, in whole numbers.
int runLength(const HalfwayOrders& n, const HalfwayTerm& t, int d) {
    const long long half = n.half, along = n.difference, azimuth = n.azimuth;
    if (!t.lobe) {
        // i <= 6/5 A - j A / (D / 2) - d
        const long long v = smoothAlongV(n);
        const long long room = 6 * azimuth * v - 5 * t.j * azimuth - 5 * d * v;
        return room < 0 ? 0 : static_cast<int>(room / (5 * v) + 1);
    }
    // 60 H D A times 23/20 - j/D - 10 d / (3 A), over 60 D A
    const long long room =
        69 * half * along * azimuth - 60 * t.j * half * azimuth - 200 * d * half * along;
    return room < 0 ? 0 : static_cast<int>(std::min(half, room / (60 * along * azimuth) + 1));
}

void checkOrders(const HalfwayOrders& orders) {
    for (const int n : {orders.half, orders.difference, orders.azimuth}) {
        if (n >= 1 && n <= maxOrder) continue;
        throw UsageError(
            fmt::format("orders {},{},{} of the halfway form: each has to be from 1 to {}",
                        orders.half, orders.difference, orders.azimuth, maxOrder));
    }
}

[[noreturn]] void refuseSize(const HalfwayOrders& orders) {
    throw UsageError(
        fmt::format("orders {},{},{} of the halfway form make more than {} terms: ask for fewer "
                    "functions",
                    orders.half, orders.difference, orders.azimuth, maxTerms));
}

/// Calls `add` for every product of one exponent but its i, by rising q.
template <class Add>
void forEachRun(const HalfwayOrders& orders, const HalfwaySymmetry& symmetry, bool lobe, Add add) {
    const int lastHarmonic =
        symmetry.isotropic ? 0 : (symmetry.bilateral ? 2 : 1) * (orders.azimuth - 1);
    const int alongV = lobe ? orders.difference : smoothAlongV(orders);
    for (int q = 0; q <= lastHarmonic; ++q) {
        for (int bits = 0; bits < 8; ++bits) {
            for (int k = 0; k < orders.azimuth; ++k) {
                HalfwayTerm t{.lobe = lobe,
                              .k = k,
                              .q = q,
                              .exchange = (bits & 1) != 0,
                              .mirror = (bits & 2) != 0,
                              .sine = (bits & 4) != 0};
                if (!allowed(t, symmetry)) continue;
                for (t.j = 0; t.j < alongV; ++t.j) add(t);
            }
        }
    }
}

}  // namespace

HalfwayTerms::HalfwayTerms(const HalfwayOrders& orders, const HalfwaySymmetry& symmetry)
    : orders_(orders) {
    checkOrders(orders);
    for (const bool lobe : {false, true}) {
        forEachRun(orders, symmetry, lobe, [&](const HalfwayTerm& term) {
            const int length = runLength(orders, term, degreeOf(term, symmetry));
            if (length == 0) return;
            if (terms_.size() + static_cast<std::size_t>(length) > maxTerms) refuseSize(orders);
            runs_.push_back({term, terms_.size(), static_cast<std::size_t>(length)});
            for (int i = 0; i < length; ++i) {
                terms_.push_back(term);
                terms_.back().i = i;
            }
            harmonics_ = std::max(harmonics_, term.q);
            counts_.v = std::max(counts_.v, term.j + 1);
            int& along = lobe ? counts_.x : counts_.mean;
            along = std::max(along, length);
            if (!lobe) counts_.product = std::max(counts_.product, term.k + 1);
        });
        if (!lobe) smooth_ = terms_.size();
    }
    // Stored by degree, so that neighbours are of like magnitude.
    std::vector<std::size_t> order(terms_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) {
        const auto key = [&](const HalfwayTerm& t) {
            const int d = degreeOf(t, symmetry);
            return std::tuple(t.lobe, t.i + t.j + d, t.j, t.k, t.i, t.q, t.exchange, t.mirror,
                              t.sine);
        };
        return key(terms_[l]) < key(terms_[r]);
    });
    std::vector<HalfwayTerm> sorted(terms_.size());
    position_.resize(terms_.size());
    for (std::size_t n = 0; n < order.size(); ++n) {
        sorted[n] = terms_[order[n]];
        position_[order[n]] = n;
    }
    terms_ = std::move(sorted);
}

void HalfwayTerms::evaluate(const HalfwayPoint& point, double* out) const {
    constexpr std::size_t mean = 0, product = 1, v = 2, x = 3;
    FourValues values[mostPolynomials];
    legendre({point.mean, point.product, point.v, point.x},
             std::max({counts_.mean, counts_.product, counts_.v, counts_.x}), values);
    const double scale = std::sqrt(2.0) * point.x;
    int q = 0;
    double harmonic[2] = {1, 0};
    for (const HalfwayRun& run : runs_) {
        const HalfwayTerm& t = run.term;
        if (t.q < q) {  // the second exponent begins
            q = 0;
            harmonic[0] = 1;
            harmonic[1] = 0;
        }
        for (; q < t.q; ++q) {
            const double c = harmonic[0], s = harmonic[1];
            harmonic[0] = c * point.cosine - s * point.sine;
            harmonic[1] = c * point.sine + s * point.cosine;
        }
        double factor = values[t.j][v];
        if (!t.lobe) {
            factor *= values[t.k][product];
            if (t.exchange) factor *= point.gap;
        } else if (t.power() > 0) {
            factor *= point.x;
            for (int n = 0; n < t.power(); ++n) factor *= point.kappa;
        }
        if (t.mirror) factor *= point.handed;
        if (q > 0) factor *= scale * harmonic[t.sine ? 1 : 0];
        const std::size_t along = t.lobe ? x : mean;
        const std::size_t* place = position_.data() + run.first;
        for (std::size_t i = 0; i < run.length; ++i) out[place[i]] = factor * values[i][along];
    }
}

HalfwayOrders halfwayOrdersOr(const HalfwayOrders& asked, bool isotropic, bool reciprocal) {
    if (asked.half != 0) return asked;
    if (!isotropic) return {8, 8, 6};
    return reciprocal ? HalfwayOrders{9, 13, 5} : HalfwayOrders{9, 8, 6};
}

HalfwaySymmetry halfwaySymmetryOf(const CoefficientHead& head) {
    return {head.isotropic, head.bilateral, head.reciprocal};
}

}  // namespace hshfit::inline representation::inline halfway
