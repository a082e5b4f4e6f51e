// Terms of lambert.h: none. Included by lambert.cpp once for each instruction set.

#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class LambertTerms {
public:
    static constexpr std::size_t count = 0;

    HWY_INLINE LambertTerms(const LambertShape&, const OutgoingOf<T>&) {}
    HWY_INLINE void operator()(const Incoming<RealOf<T>>&, T*) const {}
};

struct LambertFormula {
    template <class T>
    using Terms = LambertTerms<T>;

    template <class N>
    static LambertShape shape(const Values<N>&) {
        return {};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {}};
    }
};

void evalLambert(const LambertShape& shape, const TermBatch& batch) {
    evalLanes<LambertTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> lambertColumns(const ColumnRequest& request) {
    return columnsOf<LambertFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
