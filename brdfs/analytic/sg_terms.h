// Terms of sg.h. Included by sg.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class SphericalGaussianTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE SphericalGaussianTerms(const SphericalGaussianShape& shape, const Direction& wo)
        : wo_(wo), shape_(shape) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const T versine = shape_.aboutNormal ? slopeVersine(HalfVector<T>(wo_, wi).squaredSlope())
                                             : mirrorVersine(wi);
        term[0] = exp(-shape_.sharpness * versine);
    }

private:
    /// 1 - cos of the angle to the mirror direction, from the distance to it.
    HWY_INLINE T mirrorVersine(const Incoming<T>& wi) const {
        const T dx = wi.x + T(wo_.x), dy = wi.y + T(wo_.y), dz = wi.z - T(wo_.z);
        return 0.5 * (dx * dx + dy * dy + dz * dz);
    }

    Direction wo_;
    SphericalGaussianShape shape_;
};

void evalSphericalGaussian(const SphericalGaussianShape& shape, const TermBatch& batch) {
    evalLanes<SphericalGaussianTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
