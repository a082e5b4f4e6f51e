// Terms of charlie.h. Included by charlie.cpp once for each instruction set.

#include <brdfs/analytic/charlie_lobe.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class CharlieTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE CharlieTerms(const CharlieShape& shape, const Direction& wo)
        : soft_(shape.soft), wo_(wo), lobe_(shape.curve, T(wo.z)) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const T z = max(wi.z, T(0.0));
        T incoming = lobe_.lambda(z);
        if (soft_) {
            const T low = 1.0 - z, squared = low * low, fourth = squared * squared;
            incoming = pow(incoming, 1.0 + 2.0 * (fourth * fourth));
        }
        term[0] = lobe_(z, incoming, HalfVector<T>(wo_, wi).squaredSlope());
    }

private:
    bool soft_;
    Direction wo_;
    CharlieLobe<T> lobe_;
};

void evalCharlie(const CharlieShape& shape, const TermBatch& batch) {
    evalLanes<CharlieTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
