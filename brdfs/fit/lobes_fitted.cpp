// Lobes whose forms were chosen to fit measurements: formulas and sources are those of
// brdfs/analytic/abc.cpp and sgd.cpp.
#include <brdfs/fit/lobe_row.h>

namespace hshfit::brdfs {
namespace {

template <class T>
class AbcLobe {
public:
    AbcLobe(const T* values, const LobeWords& words)
        : b_(values[0]),
          c_(values[1]),
          inverse_(1.0 / values[2]),
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
    SgdLobe(const T* values, const LobeWords&)
        : alpha_(values[0]),
          p_(values[1]),
          lambda_(values[2]),
          c_(values[3]),
          k_(values[4]),
          theta0_(values[5]),
          f0_(values[6]),
          f1_(values[7]) {
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

}  // namespace

std::span<const LobeRow> fittedLobes() {
    static const std::vector<LobeRow> table{
        {"abc", {"B", "C", "ior"}, "A", "", makeLobe<AbcLobe, 3>},
        {"sgd",
         {"alpha", "p", "Lambda", "c", "k", "theta0", "F0", "F1"},
         "ks",
         "",
         makeLobe<SgdLobe, 8>}};
    return table;
}

}  // namespace hshfit::brdfs
