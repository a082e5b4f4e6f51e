#include <hshfit/transfer/wigner.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace hshfit::inline transfer {
namespace {

/// X(l) f(l + 1) + Y(l) f(l) + Z(l) f(l - 1) = 0.
struct Recurrence {
    double l2, l3, m1, m2, m3;

    /// A(l) = sqrt((l^2 - (l2 - l3)^2) ((l2 + l3 + 1)^2 - l^2) (l^2 - m1^2)), by differences.
    double root(double l) const {
        const double difference = (l - (l2 - l3)) * (l + (l2 - l3));
        const double sum = (l2 + l3 + 1 - l) * (l2 + l3 + 1 + l);
        return std::sqrt(difference * sum * ((l - m1) * (l + m1)));
    }
    // l = 0 occurs for l2 = l3 and m1 = 0 only: the equation divided by l has a limit.
    double x(double l) const { return l == 0 ? root(1) : l * root(l + 1); }
    double y(double l) const {
        if (l == 0) return m3 - m2;
        return -(2 * l + 1) * (m1 * (l2 * (l2 + 1) - l3 * (l3 + 1)) - l * (l + 1) * (m3 - m2));
    }
    double z(double l) const { return l == 0 ? 0 : (l + 1) * root(l); }
};

/// Neighbours l with an odd sum of all three vanish where m2 = m3 and l2 = l3, or all m are 0: two
/// terms remain, f(l + 1) = -Z / X f(l - 1), taken from the upper end in both directions of growth.
void fillEveryOther(const Recurrence& r, int first, std::vector<double>& values) {
    const auto count = static_cast<int>(values.size());
    std::fill(values.begin(), values.end(), 0.0);
    double largest = 1;
    values[static_cast<std::size_t>(count - 1)] = 1;
    for (int k = count - 2; k > 0; k -= 2) {
        const double l = first + k;
        const double value = -r.x(l) / r.z(l) * values[static_cast<std::size_t>(k + 1)];
        values[static_cast<std::size_t>(k - 1)] = value;
        largest = std::abs(value);
        if (largest > 1e100) {
            for (int j = k - 1; j < count; ++j) values[static_cast<std::size_t>(j)] /= largest;
        }
    }
}

/// The signs of the first and the last value, which may be too small to be numbers, and the values
/// up to a factor.
class TwoWays {
public:
    TwoWays(const Recurrence& r, int first, std::vector<double>& values, std::vector<double>& down)
        : r_(r), first_(first), last_(static_cast<int>(values.size()) - 1), f_(values), s_(down) {}

    /// Returns the sign of f at the upper end.
    double run() {
        s_.assign(f_.size(), 0.0);
        const int lower = upwards();
        const int upper = downwards(lower);
        // Values between, from below; growing or oscillating, so that they are stable.
        at(lower) = 1;
        for (int k = lower; k < upper; ++k) {
            const double l = first_ + k;
            const double before = k > lower ? at(k - 1) : k > 0 ? s_[index(k - 1)] * at(k) : 0;
            at(k + 1) = -(r_.y(l) * at(k) + r_.z(l) * before) / r_.x(l);
        }
        double sign = at(upper) < 0 ? -1 : 1;
        for (int k = lower - 1; k >= 0; --k) at(k) = s_[index(k)] * at(k + 1);
        for (int k = upper + 1; k <= last_; ++k) {
            at(k) = s_[index(k)] * at(k - 1);
            if (s_[index(k)] < 0) sign = -sign;
        }
        return sign;
    }

private:
    static std::size_t index(int k) { return static_cast<std::size_t>(k); }
    double& at(int k) { return f_[index(k)]; }

    /// s = f(l) / f(l + 1) from below, as long as f grows; returns the first l that has none.
    int upwards() {
        int k = 0;
        for (; k < last_; ++k) {
            const double l = first_ + k;
            const double below = k > 0 ? r_.z(l) * s_[index(k - 1)] : 0;
            const double divisor = r_.y(l) + below;
            if (divisor == 0) break;
            const double ratio = -r_.x(l) / divisor;
            if (!(std::abs(ratio) <= 1)) break;
            s_[index(k)] = ratio;
        }
        return k;
    }

    /// s = f(l) / f(l - 1) from above, as long as f grows downwards and not past `lower`.
    int downwards(int lower) {
        int k = last_;
        for (; k > lower; --k) {
            const double l = first_ + k;
            const double above = k < last_ ? r_.x(l) * s_[index(k + 1)] : 0;
            const double divisor = r_.y(l) + above;
            if (divisor == 0) break;
            const double ratio = -r_.z(l) / divisor;
            if (!(std::abs(ratio) <= 1)) break;
            s_[index(k)] = ratio;
        }
        return k;
    }

    const Recurrence& r_;
    int first_, last_;
    std::vector<double>&f_, &s_;
};

}  // namespace

void WignerFamily::compute(int l2, int l3, int m2, int m3) {
    if (std::abs(m2) > l2 || std::abs(m3) > l3) {
        throw UsageError(
            fmt::format("3j symbol with m beyond l: l = {}, {} and m = {}, {}", l2, l3, m2, m3));
    }
    const int m1 = -m2 - m3;
    first = std::max(std::abs(l2 - l3), std::abs(m1));
    values.assign(static_cast<std::size_t>(l2 + l3 - first) + 1, 1.0);
    const Recurrence r{static_cast<double>(l2), static_cast<double>(l3), static_cast<double>(m1),
                       static_cast<double>(m2), static_cast<double>(m3)};
    double sign = 1;
    if ((m2 == 0 && m3 == 0) || (l2 == l3 && m2 == m3)) {
        fillEveryOther(r, first, values);
    } else {
        sign = TwoWays(r, first, values, down_).run();
    }
    double sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        sum += (2 * (first + static_cast<double>(k)) + 1) * values[k] * values[k];
    }
    const bool negative = (l2 - l3 - m1) % 2 != 0;
    const double scale = (negative ? -sign : sign) / std::sqrt(sum);
    for (double& value : values) {
        value *= scale;
        if (std::abs(value) < std::numeric_limits<double>::min()) value = 0;
    }
}

double wigner3j(int l1, int l2, int l3, int m1, int m2, int m3) {
    if (m1 + m2 + m3 != 0 || l1 < std::abs(l2 - l3) || l1 > l2 + l3) return 0;
    if (std::abs(m1) > l1 || std::abs(m2) > l2 || std::abs(m3) > l3) return 0;
    WignerFamily family;
    family.compute(l2, l3, m2, m3);
    return family.values[static_cast<std::size_t>(l1 - family.first)];
}

}  // namespace hshfit::inline transfer
