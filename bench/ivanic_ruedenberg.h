#pragma once

#include <hshfit/rotation/rotation.h>

#include <cmath>
#include <cstdlib>
#include <vector>

/// The textbook recurrence for rotation matrices of real spherical harmonics, band by band from the
/// band before (Ivanic & Ruedenberg 1996, with their correction of 1998), as it is commonly
/// written: the peer that bench/rotation.cpp compares with.
class IvanicRuedenberg {
public:
    /// out = R in, order^2 values.
    void rotate(const hshfit::Rotation& rotation, int order, const double* in, double* out) {
        const auto& r = rotation.matrix();
        // The first band in the order y, z, x, without the Condon-Shortley sign.
        constexpr int axis[3] = {1, 2, 0};
        bands_.resize(static_cast<std::size_t>(order));
        bands_[0] = {1};
        for (int l = 1; l < order; ++l) {
            auto& band = bands_[static_cast<std::size_t>(l)];
            band.resize(static_cast<std::size_t>((2 * l + 1) * (2 * l + 1)));
            for (int m = -l; m <= l; ++m)
                for (int n = -l; n <= l; ++n)
                    band[static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l)] =
                        l == 1 ? r[static_cast<std::size_t>(3 * axis[m + 1] + axis[n + 1])]
                               : entry(l, m, n);
        }
        for (int l = 0; l < order; ++l) {
            const double* band = bands_[static_cast<std::size_t>(l)].data();
            for (int m = -l; m <= l; ++m) {
                double sum = 0;
                for (int n = -l; n <= l; ++n)
                    sum += band[(m + l) * (2 * l + 1) + n + l] * in[l * (l + 1) + n];
                out[l * (l + 1) + m] = sum;
            }
        }
    }

private:
    double at(int l, int m, int n) const {
        return bands_[static_cast<std::size_t>(l)]
                     [static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l)];
    }
    double p(int i, int l, int a, int b) const {
        if (b == l) return at(1, i, 1) * at(l - 1, a, l - 1) - at(1, i, -1) * at(l - 1, a, 1 - l);
        if (b == -l) return at(1, i, 1) * at(l - 1, a, 1 - l) + at(1, i, -1) * at(l - 1, a, l - 1);
        return at(1, i, 0) * at(l - 1, a, b);
    }
    double v(int l, int m, int n) const {
        if (m == 0) return p(1, l, 1, n) + p(-1, l, -1, n);
        const double d = std::abs(m) == 1 ? 1 : 0;
        if (m > 0) return p(1, l, m - 1, n) * std::sqrt(1 + d) - (d == 0 ? p(-1, l, 1 - m, n) : 0);
        return (d == 0 ? p(1, l, m + 1, n) : 0) + p(-1, l, -m - 1, n) * std::sqrt(1 + d);
    }
    double w(int l, int m, int n) const {
        if (m > 0) return p(1, l, m + 1, n) + p(-1, l, -m - 1, n);
        return p(1, l, m - 1, n) - p(-1, l, 1 - m, n);
    }
    double entry(int l, int m, int n) const {
        const double d = m == 0 ? 1 : 0, a = std::abs(m);
        const double below = std::abs(n) == l ? 2.0 * l * (2 * l - 1) : (l + n) * (l - n);
        double sum = 0;
        const double u = std::sqrt((l + m) * (l - m) / below);
        if (u != 0) sum += u * p(0, l, m, n);
        const double cv = 0.5 * std::sqrt((1 + d) * (l + a - 1) * (l + a) / below) * (1 - 2 * d);
        if (cv != 0) sum += cv * v(l, m, n);
        const double cw = -0.5 * std::sqrt((l - a - 1) * (l - a) / below) * (1 - d);
        if (cw != 0) sum += cw * w(l, m, n);
        return sum;
    }

    std::vector<std::vector<double>> bands_;
};
