// Lobes of facets whose slopes are distributed: formulas and sources are those of brdfs/analytic/;
// isotropic.
#include <brdfs/fit/lobe_gtr.h>
#include <brdfs/fit/lobe_row.h>

#include <numbers>
#include <type_traits>

namespace hshfit::brdfs {
namespace {

template <class T>
class WardLobe {
public:
    WardLobe(const T* values, const LobeWords& words)
        : inverse_(1.0 / (values[0] * values[0])), variant_(words.at("variant")[0]) {}
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

/// D, and z Lambda of a direction of height z.
template <class T>
class Ggx {
public:
    explicit Ggx(const T* shape) : squared_(shape[0] * shape[0]) {}
    T density(const PairGeometry& g) const {
        const T ratio = (1 + g.squaredSlope) / (squared_ + g.squaredSlope);
        return ratio * ratio * squared_ * (1 / pi);
    }
    T masked(double z) const {
        using std::sqrt;
        const T s = squared_ * std::max(0.0, (1 - z) * (1 + z));
        return 0.5 * s / (z + sqrt(z * z + s));
    }

private:
    T squared_;
};

template <class T>
class Beckmann {
public:
    explicit Beckmann(const T* shape) : alpha_(shape[0]), inverse_(1.0 / (shape[0] * shape[0])) {}
    T density(const PairGeometry& g) const {
        using std::exp;
        const double rise = 1 + g.squaredSlope;
        return inverse_ * exp(inverse_ * -g.squaredSlope) * (rise * rise / pi);
    }
    /// M = (s exp(-a^2) / sqrt(pi) - z erfc(a)) / 2 with s = alpha sin, a = z / s, so that
    /// dM/ds = exp(-a^2) / (2 sqrt(pi)).
    T masked(double z) const {
        const double sine = std::max(1e-12, std::sqrt((1 - z) * (1 + z)));
        const double s = valueOf(alpha_) * sine, a = z / s;
        if (a > 6) return T(0.0);  // less than rounding of z, to which it is added
        const double bell = 0.5 * std::numbers::inv_sqrtpi * std::exp(-a * a);
        return chained(s * bell - 0.5 * z * std::erfc(a), sine * bell);
    }

private:
    static double valueOf(const T& x) {
        if constexpr (std::is_same_v<T, double>)
            return x;
        else
            return x.a;
    }
    /// A function of alpha from its value and slope.
    T chained(double value, double slope) const {
        if constexpr (std::is_same_v<T, double>)
            return value;
        else
            return T(value, slope * alpha_.v);
    }

    T alpha_, inverse_;
};

/// D G / (4 cos_i cos_o) with Smith's masking, and Schlick's F: values are F0, those of the
/// distribution. `scaled`: times F, for ks to multiply; else the first value is ks, and F0
/// multiplies what is returned.
template <template <class> class Distribution, bool scaled, class T>
class SmithLobe {
public:
    SmithLobe(const T* values, const LobeWords& words)
        : first_(values[0]),
          distribution_(values + 1),
          correlated_(words.at("masking") == "correlated") {}
    T operator()(const PairGeometry& g, T& base) const {
        const T in = distribution_.masked(g.cosI), out = distribution_.masked(g.cosO);
        const T visible = correlated_ ? g.cosI * g.cosO + g.cosO * in + g.cosI * out
                                      : (g.cosI + in) * (g.cosO + out);
        const T lobe = 0.25 * distribution_.density(g) / visible;
        const double weight = g.schlick();
        if constexpr (scaled) return lobe * (first_ * (1 - weight) + weight);
        base += first_ * lobe * weight;
        return first_ * lobe * (1 - weight);
    }

private:
    T first_;
    Distribution<T> distribution_;
    bool correlated_;
};
template <class T>
using GgxLobe = SmithLobe<Ggx, true, T>;
template <class T>
using GgxReflectance = SmithLobe<Ggx, false, T>;
template <class T>
using BeckmannLobe = SmithLobe<Beckmann, true, T>;
template <class T>
using BeckmannReflectance = SmithLobe<Beckmann, false, T>;
template <class T>
using GtrLobe = SmithLobe<GtrDistribution, true, T>;
template <class T>
using GtrReflectance = SmithLobe<GtrDistribution, false, T>;

template <class T>
class CookTorranceLobe {
public:
    CookTorranceLobe(const T* values, const LobeWords& words)
        : f0_(values[0]),
          inverse_(1.0 / (values[1] * values[1])),
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

}  // namespace

std::span<const LobeRow> facetLobes() {
    constexpr std::string_view schlick = "fresnel=schlick";
    static const std::vector<LobeRow> table{
        {"ward", {"ax"}, "ks", "", makeLobe<WardLobe, 1>},
        {"ggx", {"F0", "alpha"}, "ks", schlick, makeLobe<GgxLobe, 2>},
        {"ggx", {"ks", "alpha"}, "F0", schlick, makeLobe<GgxReflectance, 2>},
        {"beckmann", {"F0", "alpha"}, "ks", schlick, makeLobe<BeckmannLobe, 2>},
        {"beckmann", {"ks", "alpha"}, "F0", schlick, makeLobe<BeckmannReflectance, 2>},
        {"gtr", {"F0", "alpha", "gamma"}, "ks", schlick, makeLobe<GtrLobe, 3>},
        {"gtr", {"ks", "alpha", "gamma"}, "F0", schlick, makeLobe<GtrReflectance, 3>},
        {"cook-torrance", {"F0", "m"}, "ks", "fresnel=exact", makeLobe<CookTorranceLobe, 2>},
        {"cook-torrance", {"F0", "m"}, "ks", schlick, makeLobe<CookTorranceLobe, 2>}};
    return table;
}

}  // namespace hshfit::brdfs
