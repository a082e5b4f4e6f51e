#include <hshfit/bases/internal/half_range.h>

#include <cassert>
#include <cmath>
#include <limits>

namespace hshfit::bases {

namespace {

/// Turns the Jacobi matrix J of a weight w into the Jacobi matrix of the weight (1 + sign mu) w:
/// with L L^T = I + sign J it is sign (L^T L - I) without the last row and column.
void multiplyWeight(double sign, HalfRangeRecurrence& q) {
    const std::size_t n = q.diagonal.size();
    double pivot = 1 + sign * q.diagonal[0];  // L_kk^2
    for (std::size_t k = 0; k + 1 < n; ++k) {
        const double b = q.offDiagonal[k + 1];
        const double below = b * b / pivot;  // L_{k+1,k}^2
        const double next = 1 + sign * q.diagonal[k + 1] - below;
        q.diagonal[k] = sign * (pivot + below - 1);
        q.offDiagonal[k + 1] = std::sqrt(below * next);
        pivot = next;
    }
    q.diagonal.pop_back();
    q.offDiagonal.pop_back();
}

}  // namespace

std::vector<HalfRangeRecurrence> halfRangeRecurrences(int order) {
    HalfRangeRecurrence q;
    for (int k = 0; k < 2 * order; ++k) {
        q.diagonal.push_back(0.5);
        q.offDiagonal.push_back(0.5 * k / std::sqrt(std::abs(4.0 * k * k - 1)));
    }
    std::vector<HalfRangeRecurrence> all;
    for (int m = 0; m < order; ++m) {
        if (m > 0) {
            multiplyWeight(1, q);
            multiplyWeight(-1, q);
            q.first *= std::sqrt((2 * m + 1) / (2.0 * m));
        }
        all.push_back(q);
    }
    return all;
}

void halfRangeTheta(const HalfRangeRecurrence& q, int m, int count,
                    std::span<const Elevation<double>> points, double* out) {
    assert(static_cast<std::size_t>(count) <= q.diagonal.size());
    const std::size_t n = points.size();
    for (std::size_t p = 0; p < n; ++p) {
        const auto [mu, oneMinusMu] = points[p];
        const double sine = std::sqrt(oneMinusMu * (1 + mu));
        double value = mu < 0 ? 0 : q.first * std::pow(sine, m), last = 0;
        const bool nearPole = oneMinusMu < 0.5;
        for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
            const bool tiny = std::abs(value) < std::numeric_limits<double>::min();
            out[k * n + p] = tiny ? 0 : value;
            if (k + 1 == static_cast<std::size_t>(count)) break;
            // mu - a_k; near the pole the small 1 - mu has more digits than mu.
            const double x = nearPole ? (1 - q.diagonal[k]) - oneMinusMu : mu - q.diagonal[k];
            const double next = (x * value - q.offDiagonal[k] * last) / q.offDiagonal[k + 1];
            last = value;
            value = next;
        }
    }
}

}  // namespace hshfit::bases
