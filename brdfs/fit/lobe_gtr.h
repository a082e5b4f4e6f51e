#pragma once

#include <brdfs/fit/lobe_geometry.h>

#include <array>
#include <numbers>
#include <vector>

namespace hshfit::brdfs {

/// D and Smith's z Lambda of brdfs/analytic/gtr.h for any scalar. Lambda over GGX's is tabulated
/// more coarsely than there, over the logarithm of cot(theta) / alpha, and interpolated by
/// polynomials of degree 7: within 1e-7 of the catalog's.
template <class T>
class GtrDistribution {
public:
    explicit GtrDistribution(const T* shape)
        : alpha_(shape[0]), gamma_(shape[1]), squared_(alpha_ * alpha_) {
        using std::exp;
        using std::log;
        logAlpha_ = log(alpha_);
        peak_ = growth(2.0 * logAlpha_) / growth((1.0 - gamma_) * 2.0 * logAlpha_) *
                exp(-2.0 * gamma_ * logAlpha_) / pi;
        for (int k = 0; k < count; ++k) values_.push_back(nodeValue(first + step * k));
    }

    T density(const PairGeometry& g) const {
        using std::exp;
        using std::log;
        return peak_ *
               exp(gamma_ * (std::log1p(g.squaredSlope) - log(1.0 + g.squaredSlope / squared_)));
    }

    /// z Lambda of a direction of height z.
    T masked(double z) const {
        using std::exp;
        using std::sqrt;
        const double squaredSine = (1 - z) * (1 + z);
        if (!(squaredSine > 0)) return T(0.0);
        const T s = squared_ * squaredSine;
        const T ggx = 0.5 * s / (z + sqrt(z * z + s));
        return ggx * exp(interpolated(std::log(z) - 0.5 * std::log(squaredSine) - logAlpha_));
    }

private:
    static constexpr double first = -16, last = 21.5, step = 0.25;
    static constexpr int count = static_cast<int>((last - first) / step) + 1, points = 8;

    static double real(double x) { return x; }
    template <class Jet>
    static double real(const Jet& x) {
        return x.a;
    }

    /// (exp(x) - 1) / x
    static T growth(const T& x) {
        using std::exp;
        if (std::abs(real(x)) > 1e-3) return (exp(x) - 1.0) / x;
        return 1.0 + x * (0.5 + x * (1 / 6. + x * (1 / 24.)));
    }

    /// log of Lambda over GGX's at cot(theta) = alpha exp(at).
    T nodeValue(double at) const {
        using std::atan2;
        using std::exp;
        using std::log;
        using std::sqrt;
        const T cotangent = alpha_ * std::exp(at), squaredCotangent = cotangent * cotangent;
        const T scale = alpha_ * std::sqrt(1 + std::exp(2 * at));
        T sum(0.0);
        constexpr double stride = 0.15;
        for (int i = -60; i <= 240; ++i) {
            const T w = scale * std::exp(i * stride), squared = w * w + squaredCotangent;
            const T rise = 1.0 + squared;
            const T slopes = exp(gamma_ * log(rise / (1.0 + squared / squared_))) / (rise * rise);
            // w - cot atan(w / cot), by its series where the two cancel; the ratio does not depend
            // on alpha.
            const double ratio = std::exp(i * stride - at) * std::sqrt(1 + std::exp(2 * at));
            const double excess = ratio < 1e-3 ? ratio * ratio * (1. / 3 - ratio * ratio / 5)
                                               : 1 - std::atan(ratio) / ratio;
            sum += slopes * w * w * w * excess;
        }
        // Over the sine: Lambda / cos; GGX's likewise.
        const T ggx = 0.5 * squared_ / (cotangent + sqrt(squaredCotangent + squared_));
        return log(2.0 * peak_ * sum * stride / ggx);
    }

    T interpolated(const T& at) const {
        const double position =
            std::clamp((real(at) - first) / step, 0.0, static_cast<double>(count - 1));
        const int left = std::clamp(static_cast<int>(position) - points / 2 + 1, 0, count - points);
        const bool beyond = real(at) < first || real(at) > last;
        const T u = beyond ? T(position - left) : (at - first) / step - double(left);
        // Newton's divided differences would do; Lagrange's form needs no state.
        T sum(0.0);
        static constexpr std::array<double, points> inverse{
            -1 / 5040., 1 / 720., -1 / 240., 1 / 144., -1 / 144., 1 / 240., -1 / 720., 1 / 5040.};
        std::array<T, points + 1> after;
        after[points] = T(1.0);
        for (int k = points - 1; k >= 0; --k) after[k] = after[k + 1] * (u - double(k));
        T before(1.0);
        for (int k = 0; k < points; ++k) {
            sum += values_[left + k] * inverse[k] * before * after[k + 1];
            before *= u - double(k);
        }
        return sum;
    }

    T alpha_, gamma_, squared_, logAlpha_, peak_;
    std::vector<T> values_;
};

}  // namespace hshfit::brdfs
