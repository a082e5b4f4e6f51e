// Terms of blinn_phong.h. Included by blinn_phong.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class BlinnPhongTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE BlinnPhongTerms(const BlinnPhongShape<ParameterOf<T>>& shape,
                               const OutgoingOf<T>& wo)
        : wo_(wo), power_(-0.5 * shape.exponent) {}

    HWY_INLINE void operator()(const Incoming<RealOf<T>>& wi, T* term) const {
        term[0] = exp(power_ * log1p(HalfVector<RealOf<T>>(wo_, wi).squaredSlope()));
    }

private:
    OutgoingOf<T> wo_;
    T power_;
};

struct BlinnPhongFormula {
    template <class T>
    using Terms = BlinnPhongTerms<T>;

    template <class N>
    static BlinnPhongShape<N> shape(const Values<N>& p) {
        return {p("exponent")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("ks") * scale(p)}};
    }
    template <class N>
    static N scale(const Values<N>& p) {
        const N n = p("exponent");
        if (p.chosen("normalized", "true")) return exactFactor(n);
        return p.chosen("normalized", "phong") ? (n + 2) / (2 * pi) : N(1.0);
    }
    /// Gives the lobe an albedo of 1 at normal incidence.
    template <class N>
    static N exactFactor(const N& n) {
        return (n + 2) * (n + 4) / (8 * pi * (exp2(-n / 2) + n));
    }
};

void evalBlinnPhong(const BlinnPhongShape<double>& shape, const TermBatch& batch) {
    evalLanes<BlinnPhongTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> blinnPhongColumns(const ColumnRequest& request) {
    return columnsOf<BlinnPhongFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
