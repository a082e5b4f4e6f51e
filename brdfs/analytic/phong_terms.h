// Terms of phong.h. Included by phong.cpp once for each instruction set.

#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class PhongTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE PhongTerms(const PhongShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : wo_(wo), exponent_(shape.exponent) {}

    HWY_INLINE void operator()(const Incoming<RealOf<T>>& wi, T* term) const {
        using R = RealOf<T>;
        const R dx = wi.x + R(wo_.x), dy = wi.y + R(wo_.y), dz = wi.z - R(wo_.z);
        const R versine = 0.5 * (dx * dx + dy * dy + dz * dz);
        const R cosine = wi.z * wo_.z - wi.x * wo_.x - wi.y * wo_.y;
        const T power = exp(exponent_ * logNearOne(cosine, -versine));
        term[0] = select(cosine > R(0.0), power, T(0.0));
    }

private:
    OutgoingOf<T> wo_;
    T exponent_;
};

struct PhongFormula {
    template <class T>
    using Terms = PhongTerms<T>;

    template <class N>
    static PhongShape<N> shape(const Values<N>& p) {
        return {p("exponent")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("ks") * scale(p)}};
    }
    template <class N>
    static N scale(const Values<N>& p) {
        return p.chosen("normalized", "true") ? (p("exponent") + 2) / (2 * pi) : N(1.0);
    }
};

void evalPhong(const PhongShape<double>& shape, const TermBatch& batch) {
    evalLanes<PhongTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> phongColumns(const ColumnRequest& request) {
    return columnsOf<PhongFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
