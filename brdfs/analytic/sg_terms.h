// Terms of sg.h. Included by sg.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class SphericalGaussianTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE SphericalGaussianTerms(const SphericalGaussianShape<ParameterOf<T>>& shape,
                                      const OutgoingOf<T>& wo)
        : wo_(wo), sharpness_(shape.sharpness), aboutNormal_(shape.aboutNormal) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const R versine =
            aboutNormal_ ? slopeVersine(HalfVector<R>(wo_, wi).squaredSlope()) : mirrorVersine(wi);
        term[0] = exp(-sharpness_ * versine);
    }

private:
    /// 1 - cos of the angle to the mirror direction, from the distance to it.
    HWY_INLINE R mirrorVersine(const Incoming<R>& wi) const {
        const R dx = wi.x + R(wo_.x), dy = wi.y + R(wo_.y), dz = wi.z - R(wo_.z);
        return 0.5 * (dx * dx + dy * dy + dz * dz);
    }

    OutgoingOf<T> wo_;
    T sharpness_;
    bool aboutNormal_;
};

struct SphericalGaussianFormula {
    template <class T>
    using Terms = SphericalGaussianTerms<T>;

    template <class N>
    static SphericalGaussianShape<N> shape(const Values<N>& p) {
        return {p("sharpness"), p.chosen("axis", "normal")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("ks") * scale(p)}};
    }
    template <class N>
    static N scale(const Values<N>& p) {
        if (p.chosen("normalized", "false")) return N(1.0);
        return sphereFactor(p("sharpness")) / (p.chosen("axis", "normal") ? 4 : 1);
    }
    /// Makes the integral over the sphere 1.
    template <class N>
    static N sphereFactor(const N& sharpness) {
        return sharpness > N(0.0) ? sharpness / (-2 * pi * expm1(-2 * sharpness)) : N(1 / (4 * pi));
    }
};

void evalSphericalGaussian(const SphericalGaussianShape<double>& shape, const TermBatch& batch) {
    evalLanes<SphericalGaussianTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> sphericalGaussianColumns(const ColumnRequest& request) {
    return columnsOf<SphericalGaussianFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
