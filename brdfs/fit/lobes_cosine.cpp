// Lobes that are powers of a cosine, or Gaussians of an angle: formulas and sources are those of
// brdfs/analytic/.
#include <brdfs/fit/lobe_row.h>

namespace hshfit::brdfs {
namespace {

template <class T>
class BlinnPhongLobe {
public:
    BlinnPhongLobe(const T* values, const LobeWords& words) : exponent_(values[0]), scale_(1.0) {
        using std::exp;
        const T &n = exponent_, two = 2.0 + n;
        const std::string& norm = words.at("normalized");
        if (norm == "phong") scale_ = two / (2 * pi);
        if (norm == "true")
            scale_ = two * (4.0 + n) / (8 * pi * (exp(n * (-0.5 * std::numbers::ln2)) + n));
    }
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        return scale_ * exp(exponent_ * (-0.5 * std::log1p(g.squaredSlope)));
    }

private:
    T exponent_, scale_;
};

template <class T>
class PhongLobe {
public:
    PhongLobe(const T* values, const LobeWords& words) : exponent_(values[0]), scale_(1.0) {
        if (words.at("normalized") == "true") scale_ = (exponent_ + 2.0) / (2 * pi);
    }
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        const double versine = g.mirrorVersine();
        return versine < 1 ? scale_ * exp(exponent_ * std::log1p(-versine)) : T(0.0);
    }

private:
    T exponent_, scale_;
};

template <class T>
class LafortuneLobe {
public:
    LafortuneLobe(const T* values, const LobeWords&)
        : x_(values[3]), y_(values[0]), z_(values[1]), exponent_(values[2]) {}
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        using std::log;
        const T less = halfSquare(x_, g.in.x, g.out.x) + halfSquare(y_, g.in.y, g.out.y) +
                       halfSquare(z_, g.in.z, g.out.z);
        return less < T(1.0) ? exp(exponent_ * log(1.0 - less)) : T(0.0);
    }

private:
    /// Half of a^2 + b^2 - 2 c a b.
    static T halfSquare(const T& c, double a, double b) {
        const double sign = c < T(0.0) ? -1 : 1, difference = a - sign * b;
        return 0.5 * difference * difference - (c - sign) * (a * b);
    }
    T x_, y_, z_, exponent_;
};

template <class T>
class AshikhminShirleyLobe {
public:
    AshikhminShirleyLobe(const T* values, const LobeWords&)
        : f0_(values[0]), exponent_(values[1]), peak_((values[1] + 1.0) / (8 * pi)) {}
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        const T power = exp(exponent_ * (-0.5 * std::log1p(g.squaredSlope)));
        return peak_ * power * (f0_ + (1.0 - f0_) * g.schlick()) *
               (1 / g.dot / std::max(g.cosI, g.cosO));
    }

private:
    T f0_, exponent_, peak_;
};

template <class T>
class SphericalGaussianLobe {
public:
    SphericalGaussianLobe(const T* values, const LobeWords& words)
        : sharpness_(values[0]), scale_(1.0), aboutNormal_(words.at("axis") == "normal") {
        using std::exp;
        if (words.at("normalized") == "true" && sharpness_ > T(0.0))
            scale_ = sharpness_ / ((aboutNormal_ ? 8 : 2) * pi * (1.0 - exp(-2.0 * sharpness_)));
    }
    T operator()(const PairGeometry& g, T&) const {
        using std::exp;
        return scale_ * exp(sharpness_ * -(aboutNormal_ ? g.tiltVersine() : g.mirrorVersine()));
    }

private:
    T sharpness_, scale_;
    bool aboutNormal_;
};

}  // namespace

std::span<const LobeRow> cosineLobes() {
    static const std::vector<LobeRow> table{
        {"blinn-phong", {"exponent"}, "ks", "", makeLobe<BlinnPhongLobe, 1>},
        {"phong", {"exponent"}, "ks", "", makeLobe<PhongLobe, 1>},
        {"lafortune",
         {"Cy", "Cz", "exponent", "Cx"},
         "ks",
         "normalized=false",
         makeLobe<LafortuneLobe, 3>},
        {"ashikhmin-shirley", {"Rs", "nu"}, "ks", "", makeLobe<AshikhminShirleyLobe, 2>},
        {"sg", {"sharpness"}, "ks", "", makeLobe<SphericalGaussianLobe, 1>}};
    return table;
}

}  // namespace hshfit::brdfs
