// Terms of minnaert.h. Included by minnaert.cpp once for each instruction set.

#include <brdfs/analytic/term_batch.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class MinnaertTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE MinnaertTerms(const MinnaertShape& shape, const Direction& wo)
        : exponent_(shape.k - 1),
          outgoing_(bounded(0.5 * (shape.k + 1) * pow(T(wo.z), T(exponent_)))) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        term[0] = outgoing_ * bounded(pow(wi.z, T(exponent_)));
    }

private:
    double exponent_;
    T outgoing_;
};

void evalMinnaert(const MinnaertShape& shape, const TermBatch& batch) {
    evalLanes<MinnaertTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
