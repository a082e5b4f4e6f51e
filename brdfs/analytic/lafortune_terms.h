// Terms of lafortune.h. Included by lafortune.cpp once for each instruction set.

#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Half of a^2 + b^2 - 2 c a b, without cancellation where |c| = 1 and b is near c a.
template <class T>
struct HalfSquare {
    double sign;
    T rest;

    template <class N>
    explicit HWY_INLINE HalfSquare(const N& c) : sign(c < N(0.0) ? -1 : 1), rest(c - sign) {}

    template <class W>
    HWY_INLINE T operator()(RealOf<T> a, W b) const {
        const RealOf<T> difference = a - RealOf<T>(sign * b);
        return 0.5 * difference * difference - rest * b * a;
    }
};

template <class T>
class LafortuneTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE LafortuneTerms(const LafortuneShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : cx_(shape.x),
          cy_(shape.y),
          cz_(shape.z),
          exponent_(shape.exponent),
          lessX_(shape.x),
          lessY_(shape.y),
          lessZ_(shape.z),
          wo_(wo) {}

    /// 1 - wi C wo = (|wi|^2 + |wo|^2) / 2 - wi C wo for unit vectors.
    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const T less = lessX_(wi.x, wo_.x) + lessY_(wi.y, wo_.y) + lessZ_(wi.z, wo_.z);
        const T cosine = cx_ * wo_.x * wi.x + cy_ * wo_.y * wi.y + cz_ * wo_.z * wi.z;
        const T power = exp(exponent_ * logNearOne(cosine, -less));
        term[0] = select(cosine > T(0.0), power, T(0.0));
    }

private:
    T cx_, cy_, cz_, exponent_;
    HalfSquare<T> lessX_, lessY_, lessZ_;
    OutgoingOf<T> wo_;
};

struct LafortuneFormula {
    template <class T>
    using Terms = LafortuneTerms<T>;

    /// The diagonal of C has its largest component made 1 if normalized.
    template <class N>
    static LafortuneShape<N> shape(const Values<N>& p) {
        const N x = p("Cx"), y = p("Cy"), z = p("Cz"), most = max(max(abs(x), abs(y)), abs(z));
        if (p.chosen("normalized", "false") || most == 0) return {x, y, z, p("exponent")};
        return {x / most, y / most, z / most, p("exponent")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const bool normalized = p.chosen("normalized", "true");
        const N factor = normalized ? (p("exponent") + 2) / (2 * pi) : N(1.0);
        return {p("kd") / pi, {factor * p("ks")}};
    }
};

void evalLafortune(const LafortuneShape<double>& shape, const TermBatch& batch) {
    evalLanes<LafortuneTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> lafortuneColumns(const ColumnRequest& request) {
    return columnsOf<LafortuneFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
