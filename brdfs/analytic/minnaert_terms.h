// Terms of minnaert.h. Included by minnaert.cpp once for each instruction set.

#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class MinnaertTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE MinnaertTerms(const MinnaertShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : exponent_(shape.k - 1),
          outgoing_(bounded(T(0.5 * (shape.k + 1)) * pow(RealOf<T>(wo.z), exponent_))) {}

    HWY_INLINE void operator()(const Incoming<RealOf<T>>& wi, T* term) const {
        term[0] = outgoing_ * bounded(pow(wi.z, exponent_));
    }

private:
    T exponent_, outgoing_;
};

struct MinnaertFormula {
    template <class T>
    using Terms = MinnaertTerms<T>;

    template <class N>
    static MinnaertShape<N> shape(const Values<N>& p) {
        return {p("k")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {N(0.0), {p("kd") / pi}};
    }
};

void evalMinnaert(const MinnaertShape<double>& shape, const TermBatch& batch) {
    evalLanes<MinnaertTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> minnaertColumns(const ColumnRequest& request) {
    return columnsOf<MinnaertFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
