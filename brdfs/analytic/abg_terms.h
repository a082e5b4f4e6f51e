// Terms of abg.h. Included by abg.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class AbgTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE AbgTerms(const AbgShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : wo_(wo), b_(shape.b), half_(0.5 * shape.g) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const R x = wi.x + R(wo_.x), y = wi.y + R(wo_.y);
        // At the mirror direction itself the power is 0, and 1 for g = 0.
        const R squared = max(x * x + y * y, R(1e-300));
        term[0] = 1.0 / (b_ + exp(half_ * log(squared)));
    }

private:
    OutgoingOf<T> wo_;
    T b_, half_;
};

struct AbgFormula {
    template <class T>
    using Terms = AbgTerms<T>;

    template <class N>
    static AbgShape<N> shape(const Values<N>& p) {
        return {p("B"), p("g")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("A")}};
    }
};

void evalAbg(const AbgShape<double>& shape, const TermBatch& batch) {
    evalLanes<AbgTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> abgColumns(const ColumnRequest& request) {
    return columnsOf<AbgFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
