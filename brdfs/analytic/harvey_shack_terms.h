// Terms of harvey_shack.h. Included by harvey_shack.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class HarveyShackTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE HarveyShackTerms(const HarveyShackShape<ParameterOf<T>>& shape,
                                const OutgoingOf<T>& wo)
        : wo_(wo),
          inverse_(1.0 / (shape.l * shape.l)),
          power_(0.5 * shape.s),
          generalised_(shape.generalised) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const R x = wi.x + R(wo_.x), y = wi.y + R(wo_.y);
        const T tail = exp(power_ * log1p(inverse_ * (x * x + y * y)));
        const R mean = 0.5 * (wi.z + R(wo_.z));
        term[0] = generalised_ ? tail * (mean * mean) : tail;
    }

private:
    OutgoingOf<T> wo_;
    T inverse_, power_;
    bool generalised_;
};

struct HarveyShackFormula {
    template <class T>
    using Terms = HarveyShackTerms<T>;

    template <class N>
    static HarveyShackShape<N> shape(const Values<N>& p) {
        return {p("l"), p("s"), p.chosen("variant", "generalised")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("b0")}};
    }
};

void evalHarveyShack(const HarveyShackShape<double>& shape, const TermBatch& batch) {
    evalLanes<HarveyShackTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> harveyShackColumns(const ColumnRequest& request) {
    return columnsOf<HarveyShackFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
