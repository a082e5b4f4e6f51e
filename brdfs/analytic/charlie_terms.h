// Terms of charlie.h. Included by charlie.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class CharlieTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE CharlieTerms(const CharlieShape& shape, const Direction& wo)
        : shape_(shape),
          wo_(wo),
          scale_((2 + shape.power) / (2 * pi)),
          half_(curve(T(0.5))),
          outgoing_(lambda(T(wo.z))) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const T z = max(wi.z, T(0.0));
        T incoming = lambda(z);
        if (shape_.soft) {
            const T low = 1.0 - z, squared = low * low, fourth = squared * squared;
            incoming = pow(incoming, 1.0 + 2.0 * (fourth * fourth));
        }
        const T visible = 0.25 / (1.0 + incoming + outgoing_) / max(z * wo_.z, T(5e-324));
        const T squaredSlope = HalfVector<T>(wo_, wi).squaredSlope();
        const T squaredSine = squaredSlope / (1.0 + squaredSlope);
        term[0] = scale_ * pow(squaredSine, T(0.5 * shape_.power)) * bounded(visible);
    }

private:
    HWY_INLINE T lambda(T cosine) const {
        const auto low = cosine < T(0.5);
        const T exponent = curve(select(low, cosine, 1.0 - cosine));
        return exp(select(low, exponent, 2.0 * half_ - exponent));
    }
    HWY_INLINE T curve(T x) const {
        return shape_.a / (1.0 + shape_.b * pow(x, T(shape_.c))) + shape_.d * x + T(shape_.e);
    }

    CharlieShape shape_;
    Direction wo_;
    double scale_;
    T half_, outgoing_;
};

void evalCharlie(const CharlieShape& shape, const TermBatch& batch) {
    evalLanes<CharlieTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
