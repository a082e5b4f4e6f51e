// Terms of ward.h. Included by ward.cpp once for each instruction set.

#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class WardTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE WardTerms(const WardShape& shape, const Direction& wo)
        : wo_(wo), inverseX_(1 / shape.ax), inverseY_(1 / shape.ay), variant_(shape.variant) {
        constexpr double most = std::numeric_limits<double>::max();
        peak_ = inverseX_ * inverseY_ / pi;
        quarter_ = std::min(0.25 / wo.z, most);
        root_ = 4 * std::sqrt(wo.z);
    }

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const HalfVector<T> h(wo_, wi);
        const T x = h.x * inverseX_, y = h.y * inverseY_, squaredZ = h.z * h.z;
        const T gaussian = peak_ * exp((x * x + y * y) / -squaredZ);
        if (variant_ == WardShape::Variant::ward1992)
            term[0] = gaussian / (sqrt(wi.z) * root_);
        else if (variant_ == WardShape::Variant::duer)
            term[0] = bounded(gaussian * quarter_) / wi.z;
        else
            term[0] = h.overSquaredScale(gaussian * h.squaredLength() / (squaredZ * squaredZ));
    }

private:
    Direction wo_;
    double inverseX_, inverseY_, peak_, quarter_, root_;
    WardShape::Variant variant_;
};

void evalWard(const WardShape& shape, const TermBatch& batch) {
    evalLanes<WardTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
