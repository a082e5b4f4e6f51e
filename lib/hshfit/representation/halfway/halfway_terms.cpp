#include <hshfit/representation/halfway/halfway_terms.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr std::size_t maxTerms = 65536;
constexpr int maxOrder = 256;

/// p_0 .. p_{count-1} at x in [0, 1], by the recurrence of Legendre's polynomials.
void legendre(double x, int count, double* out) {
    const double t = 2 * x - 1;
    double before = 0, now = 1;
    for (int n = 0; n < count; ++n) {
        out[n] = std::sqrt(2.0 * n + 1) * now;
        const double next = ((2 * n + 1) * t * now - n * before) / (n + 1);
        before = now;
        now = next;
    }
}

bool allowed(const HalfwayTerm& t, const HalfwaySymmetry& symmetry) {
    if (t.sine && t.q == 0) return false;
    if (symmetry.reciprocal && t.exchange != t.mirror) return false;
    if (!symmetry.bilateral) return true;
    return t.q % 2 == 0 && t.mirror == t.sine;
}

/// Degree along the azimuth axis.
int azimuthDegree(const HalfwayTerm& t, const HalfwaySymmetry& symmetry) {
    return t.k + t.exchange + t.mirror + (symmetry.bilateral ? t.q / 2 : t.q);
}

/// The number of i that the truncation leaves for given j and d: i/H + j/D + d/A <= 7/5 in whole
/// numbers.
int runLength(const HalfwayOrders& n, int j, int d) {
    const long long h = n.half, dd = n.difference, a = n.azimuth;
    const long long room = 7 * h * dd * a - 5 * (j * h * a + d * h * dd);
    return room < 0 ? 0 : static_cast<int>(std::min(h, room / (5 * dd * a) + 1));
}

}  // namespace

HalfwayPoint halfwayPoint(const Direction& wi, const Direction& wo) {
    const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
    const double across = x * x + y * y, length = std::sqrt(across + z * z);
    const double radius = std::sqrt(across);
    HalfwayPoint p;
    p.u = std::sqrt(std::sqrt(std::min(1.0, across / (length * (length + z)))));
    p.v = std::min(1.0, length / 2);
    p.w = std::sqrt(std::min(1.0, 2 * std::sqrt(wi.z) * std::sqrt(wo.z) / z));
    p.tau = (wo.z - wi.z) / z;
    p.kappa = wi.x * wo.y - wi.y * wo.x;
    p.cosine = radius > 0 ? x / radius : 1;
    p.sine = radius > 0 ? y / radius : 0;
    return p;
}

HalfwayTerms::HalfwayTerms(const HalfwayOrders& orders, const HalfwaySymmetry& symmetry)
    : orders_(orders) {
    for (const int n : {orders.half, orders.difference, orders.azimuth}) {
        if (n < 1 || n > maxOrder) {
            throw UsageError(
                fmt::format("orders {},{},{} of the halfway form: each has to be from 1 to {}",
                            orders.half, orders.difference, orders.azimuth, maxOrder));
        }
    }
    const auto addRun = [&](const HalfwayTerm& term, int d) {
        const int length = runLength(orders, term.j, d);
        if (length == 0) return;
        runs_.push_back({term, terms_.size(), static_cast<std::size_t>(length)});
        if (terms_.size() + length > maxTerms) {
            throw UsageError(
                fmt::format("orders {},{},{} of the halfway form make more than {} "
                            "terms: ask for fewer functions",
                            orders.half, orders.difference, orders.azimuth, maxTerms));
        }
        for (int i = 0; i < length; ++i) {
            terms_.push_back(term);
            terms_.back().i = i;
        }
        harmonics_ = std::max(harmonics_, term.q);
    };
    const int lastHarmonic =
        symmetry.isotropic ? 0 : (symmetry.bilateral ? 2 : 1) * (orders.azimuth - 1);
    for (int q = 0; q <= lastHarmonic; ++q) {
        for (int bits = 0; bits < 8; ++bits) {
            for (int k = 0; k < orders.azimuth; ++k) {
                HalfwayTerm t{.k = k,
                              .q = q,
                              .exchange = (bits & 1) != 0,
                              .mirror = (bits & 2) != 0,
                              .sine = (bits & 4) != 0};
                const int d = azimuthDegree(t, symmetry);
                if (!allowed(t, symmetry) || d >= orders.azimuth) continue;
                for (t.j = 0; t.j < orders.difference; ++t.j) addRun(t, d);
            }
        }
    }
    // Stored by degree, so that neighbours are of like magnitude.
    std::vector<std::size_t> order(terms_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) {
        const auto key = [&](const HalfwayTerm& t) {
            const int d = azimuthDegree(t, symmetry);
            return std::tuple(t.i + t.j + d, d, t.j, t.i, t.q, t.exchange, t.mirror, t.sine);
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
    double alongHalf[maxOrder], alongDifference[maxOrder], alongAzimuth[maxOrder];
    legendre(point.u, orders_.half, alongHalf);
    legendre(point.v, orders_.difference, alongDifference);
    legendre(point.w, orders_.azimuth, alongAzimuth);
    int q = 0;
    double harmonic[2] = {1, 0};
    const double scale = std::sqrt(2.0) * point.u * point.u;
    for (const HalfwayRun& run : runs_) {
        for (; q < run.term.q; ++q) {
            const double c = harmonic[0], s = harmonic[1];
            harmonic[0] = c * point.cosine - s * point.sine;
            harmonic[1] = c * point.sine + s * point.cosine;
        }
        double factor = alongDifference[run.term.j] * alongAzimuth[run.term.k];
        if (run.term.exchange) factor *= point.tau;
        if (run.term.mirror) factor *= point.kappa;
        if (q > 0) factor *= scale * harmonic[run.term.sine ? 1 : 0];
        const std::size_t* place = position_.data() + run.first;
        for (std::size_t i = 0; i < run.length; ++i) out[place[i]] = factor * alongHalf[i];
    }
}

HalfwaySymmetry halfwaySymmetryOf(const CoefficientHead& head) {
    return {head.isotropic, head.bilateral, head.reciprocal};
}

}  // namespace hshfit::inline representation::inline halfway
