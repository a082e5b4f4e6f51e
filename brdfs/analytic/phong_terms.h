// Terms of phong.h. Included by phong.cpp once for each instruction set.

#include <brdfs/analytic/term_batch.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class PhongTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE PhongTerms(const PhongShape& shape, const Direction& wo)
        : wo_(wo), exponent_(shape.exponent) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const T dx = wi.x + T(wo_.x), dy = wi.y + T(wo_.y), dz = wi.z - T(wo_.z);
        const T versine = 0.5 * (dx * dx + dy * dy + dz * dz);
        const T cosine = wi.z * wo_.z - wi.x * wo_.x - wi.y * wo_.y;
        const T power = exp(exponent_ * logNearOne(cosine, -versine));
        term[0] = select(cosine > T(0.0), power, T(0.0));
    }

private:
    Direction wo_;
    double exponent_;
};

void evalPhong(const PhongShape& shape, const TermBatch& batch) {
    evalLanes<PhongTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
