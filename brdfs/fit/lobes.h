#pragma once

// Lobes of the catalog's models once more, as functions of any scalar: double, or Ceres' Jets,
// which differentiate them. Formulas and sources are those of brdfs/analytic/; isotropic; what the
// linear parameter multiplies is returned, what stands without one is added to `base`.

#include <hshfit/directions.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

namespace hshfit::brdfs {

using LobeWords = std::map<std::string, std::string>;  ///< choices of the model, by key

/// Of a pair of directions above the horizon.
struct PairGeometry {
    double cosI, cosO;
    double across;        ///< |xy|^2 of wi + wo
    double squaredSlope;  ///< tan^2 theta_h
    double squaredZ;      ///< of wi + wo
    double dot;           ///< cosine between the half vector and either direction

    PairGeometry(const Direction& wo, double x, double y, double z) : cosI(z), cosO(wo.z) {
        const double hx = x + wo.x, hy = y + wo.y, hz = z + wo.z;
        across = hx * hx + hy * hy;
        squaredZ = hz * hz;
        squaredSlope = across / squaredZ;
        dot = std::min(1.0, 0.5 * std::sqrt(across + squaredZ));
    }
    double grooves() const {
        const double open = 1 / cosI / cosO;
        return std::min(open, 2 / std::sqrt(1 + squaredSlope) / dot / std::max(cosI, cosO));
    }
    double schlick() const {
        const double rest = 1 - dot;
        return rest * rest * rest * rest * rest;
    }
};

template <class T>
class BlinnPhongLobe {
public:
    BlinnPhongLobe(const T* shapes, const LobeWords&) : exponent_(shapes[0]) {}
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        return exp(exponent_ * (-0.5 * std::log1p(g.squaredSlope)));
    }

private:
    T exponent_;
};

template <class T>
class WardLobe {
public:
    WardLobe(const T* shapes, const LobeWords& words)
        : inverse_(1.0 / (shapes[0] * shapes[0])), variant_(words.at("variant")[0]) {}
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        double factor = 1 / pi;
        if (variant_ == '1') factor /= 4 * std::sqrt(g.cosI * g.cosO);
        if (variant_ == 'd') factor /= 4 * g.cosI * g.cosO;
        if (variant_ == 'g') factor *= (1 + g.squaredSlope) / g.squaredZ;
        return inverse_ * exp(inverse_ * -g.squaredSlope) * factor;
    }

private:
    T inverse_;
    char variant_;
};

/// D F G / (4 cos_i cos_o) with Schlick's F from D and z Lambda of both directions (Smith).
template <class T>
T smithLobe(const PairGeometry& g, const T& density, const T& in, const T& out, bool correlated,
            T& base) {
    const T visible =
        correlated ? g.cosI * g.cosO + g.cosO * in + g.cosI * out : (g.cosI + in) * (g.cosO + out);
    const T lobe = 0.25 * density / visible;
    const double weight = g.schlick();
    base += lobe * weight;
    return lobe * (1 - weight);
}

template <class T>
class GgxLobe {
public:
    GgxLobe(const T* shapes, const LobeWords& words)
        : squared_(shapes[0] * shapes[0]), correlated_(words.at("masking") == "correlated") {}
    T operator()(const PairGeometry& g, T& base) const {
        const T ratio = (1 + g.squaredSlope) / (squared_ + g.squaredSlope);
        return smithLobe(g, ratio * ratio * squared_ * (1 / pi), masked(g.cosI), masked(g.cosO),
                         correlated_, base);
    }

private:
    /// z Lambda(z)
    T masked(double z) const {
        using std::sqrt;
        const T s = squared_ * std::max(0.0, (1 - z) * (1 + z));
        return 0.5 * s / (z + sqrt(z * z + s));
    }
    T squared_;
    bool correlated_;
};

template <class T>
class BeckmannLobe {
public:
    BeckmannLobe(const T* shapes, const LobeWords& words)
        : alpha_(shapes[0]),
          inverse_(1.0 / (shapes[0] * shapes[0])),
          correlated_(words.at("masking") == "correlated") {}
    T operator()(const PairGeometry& g, T& base) const {
        using std::exp;
        const double rise = 1 + g.squaredSlope;
        const T density = inverse_ * exp(inverse_ * -g.squaredSlope) * (rise * rise / pi);
        return smithLobe(g, density, masked(g.cosI), masked(g.cosO), correlated_, base);
    }

private:
    /// z Lambda(z)
    T masked(double z) const {
        using std::erfc;
        using std::exp;
        const T s = alpha_ * std::max(1e-12, std::sqrt((1 - z) * (1 + z)));
        const T a = z / s;
        return 0.5 * (exp(-a * a) * s * std::numbers::inv_sqrtpi - erfc(a) * z);
    }
    T alpha_, inverse_;
    bool correlated_;
};

/// Fresnel's reflectance of a dielectric; `inverse` is 1 / eta.
template <class T>
T fresnelOf(const T& inverse, double cosine) {
    using std::sqrt;
    const double c = std::max(cosine, 1e-9);
    const T ec = inverse * c;
    const T g = sqrt((1.0 - inverse) * (1.0 + inverse) + ec * ec);
    const T a = (g - ec) / (g + ec);
    const T b = (c * (g + ec) - inverse) / (c * (g - ec) + inverse);
    return 0.5 * a * a * (1.0 + b * b);
}

template <class T>
class CookTorranceLobe {
public:
    CookTorranceLobe(const T* shapes, const LobeWords& words)
        : f0_(shapes[0]),
          inverse_(1.0 / (shapes[1] * shapes[1])),
          schlick_(words.at("fresnel") == "schlick") {
        using std::sqrt;
        const std::string& norm = words.at("norm");
        const double scale = norm == "4" ? 4 * pi : norm == "pi" ? pi : pi * pi;
        peak_ = inverse_ / scale;
        // The root has no slope at 0.
        const T root = sqrt(f0_ > T(1e-14) ? f0_ : T(1e-14));
        eta_ = (1.0 - root) / (1.0 + root);
    }
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        const double rise = 1 + g.squaredSlope, weight = g.schlick();
        const T reflectance = schlick_ ? f0_ + (1.0 - f0_) * weight : fresnelOf(eta_, g.dot);
        return peak_ * exp(inverse_ * -g.squaredSlope) * reflectance * (rise * rise * g.grooves());
    }

private:
    T f0_, inverse_, peak_, eta_;
    bool schlick_;
};

template <class T>
class AbcLobe {
public:
    AbcLobe(const T* shapes, const LobeWords& words)
        : b_(shapes[0]),
          c_(shapes[1]),
          inverse_(1.0 / shapes[2]),
          smooth_(words.at("variant") == "smooth") {}
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        using std::log;
        const double secant = std::sqrt(1 + g.squaredSlope);
        const double versine = g.squaredSlope / (secant * (1 + secant));
        const T tail = exp(-c_ * log(1.0 + b_ * (smooth_ ? g.across : versine)));
        return fresnelOf(inverse_, g.dot) * tail * (smooth_ ? 1.0 : g.grooves() / pi);
    }

private:
    T b_, c_, inverse_;
    bool smooth_;
};

template <class T>
class SgdLobe {
public:
    SgdLobe(const T* shapes, const LobeWords&)
        : alpha_(shapes[0]),
          p_(shapes[1]),
          lambda_(shapes[2]),
          c_(shapes[3]),
          k_(shapes[4]),
          theta0_(shapes[5]),
          f0_(shapes[6]),
          f1_(shapes[7]) {
        peak_ = 1.0 / (alpha_ * upperGamma() * (pi * pi));
    }
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        using std::log;
        const T u = alpha_ + g.squaredSlope / alpha_;
        const double rise = 1 + g.squaredSlope, weight = g.schlick();
        const T fresnel = f0_ + (1.0 - f0_) * weight - f1_ * g.dot;
        if (!(fresnel > T(0.0))) return T(0.0);
        return peak_ * exp(-u - p_ * log(u)) * fresnel * visible(g.cosI) * visible(g.cosO) *
               (rise * rise);
    }

private:
    /// Gamma(1 - p, alpha) by Simpson's rule over log u, as sgd.cpp has it.
    T upperGamma() const {
        using std::exp;
        using std::log;
        constexpr int steps = 2000;
        const T low = log(alpha_), step = (std::log(750.0) - low) / double(steps);
        T sum(0.0);
        for (int i = 0; i <= steps; ++i) {
            const T v = low + step * double(i);
            const double factor = i == 0 || i == steps ? 1 : i % 2 ? 4 : 2;
            sum += factor * exp((1.0 - p_) * v - exp(v));
        }
        return sum * step * (1 / 3.0);
    }
    T visible(double z) const {
        using std::exp;
        using std::log;
        const double theta = std::acos(std::min(z, 1.0));
        const T beyond = theta - theta0_;
        if (!(beyond > T(0.0))) return T(1 / z);
        const T power = c_ * exp(k_ * log(beyond));
        if (!(power < T(700.0))) return T(0.0);
        const T open = 1.0 - lambda_ * (exp(power) - 1.0);
        if (!(open > T(0.0))) return T(0.0);
        return (open < T(1.0) ? open : T(1.0)) / z;
    }
    T alpha_, p_, lambda_, c_, k_, theta0_, f0_, f1_, peak_;
};

}  // namespace hshfit::brdfs
