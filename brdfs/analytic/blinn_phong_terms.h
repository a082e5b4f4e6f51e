// Terms of blinn_phong.h. Included by blinn_phong.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class BlinnPhongTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE BlinnPhongTerms(const BlinnPhongShape& shape, const Direction& wo)
        : wo_(wo), power_(-0.5 * shape.exponent) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        term[0] = exp(power_ * log1p(HalfVector<T>(wo_, wi).squaredSlope()));
    }

private:
    Direction wo_;
    double power_;
};

void evalBlinnPhong(const BlinnPhongShape& shape, const TermBatch& batch) {
    evalLanes<BlinnPhongTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
