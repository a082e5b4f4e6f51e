// Terms of lambert.h: none. Included by lambert.cpp once for each instruction set.

#include <brdfs/analytic/term_batch.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class LambertTerms {
public:
    static constexpr std::size_t count = 0;

    HWY_INLINE LambertTerms(const LambertShape&, const Direction&) {}
    HWY_INLINE void operator()(const Incoming<T>&, T*) const {}
};

void evalLambert(const LambertShape& shape, const TermBatch& batch) {
    evalLanes<LambertTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
