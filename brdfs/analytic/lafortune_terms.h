// Terms of lafortune.h. Included by lafortune.cpp once for each instruction set.

#include <brdfs/analytic/term_batch.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class LafortuneTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE LafortuneTerms(const LafortuneShape& shape, const Direction& wo)
        : shape_(shape), wo_(wo) {}

    /// 1 - wi C wo = (|wi|^2 + |wo|^2) / 2 - wi C wo for unit vectors.
    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const Direction& c = shape_.c;
        const T less = halfSquare(c.x, wi.x, wo_.x) + halfSquare(c.y, wi.y, wo_.y) +
                       halfSquare(c.z, wi.z, wo_.z);
        const T cosine = c.x * wo_.x * wi.x + c.y * wo_.y * wi.y + c.z * wo_.z * wi.z;
        const T power = exp(shape_.exponent * logNearOne(cosine, -less));
        term[0] = select(cosine > T(0.0), power, T(0.0));
    }

private:
    /// Half of a^2 + b^2 - 2 c a b, without cancellation where |c| = 1 and b is near c a.
    static HWY_INLINE T halfSquare(double c, T a, double b) {
        const double sign = c < 0 ? -1 : 1;
        const T difference = a - T(sign * b);
        return 0.5 * difference * difference - (c - sign) * b * a;
    }

    LafortuneShape shape_;
    Direction wo_;
};

void evalLafortune(const LafortuneShape& shape, const TermBatch& batch) {
    evalLanes<LafortuneTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
