// Terms of charlie.h. Included by charlie.cpp once for each instruction set.

#include <brdfs/analytic/charlie_lobe.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class CharlieTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE CharlieTerms(const CharlieShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : soft_(shape.soft), wo_(wo), lobe_(shape.curve, R(wo.z)) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const R z = max(wi.z, R(0.0));
        T incoming = lobe_.lambda(z);
        if (soft_) {
            const R low = 1.0 - z, squared = low * low, fourth = squared * squared;
            incoming = pow(incoming, T(1.0 + 2.0 * (fourth * fourth)));
        }
        term[0] = lobe_(z, incoming, HalfVector<R>(wo_, wi).squaredSlope());
    }

private:
    bool soft_;
    OutgoingOf<T> wo_;
    CharlieLobe<T> lobe_;
};

struct CharlieFormula {
    template <class T>
    using Terms = CharlieTerms<T>;

    template <class N>
    static CharlieShape<N> shape(const Values<N>& p) {
        return {charlieCurve(p("r")), p.chosen("terminator", "soft")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {N(0.0), {p("ks")}};
    }
};

void evalCharlie(const CharlieShape<double>& shape, const TermBatch& batch) {
    evalLanes<CharlieTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> charlieColumns(const ColumnRequest& request) {
    return columnsOf<CharlieFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
