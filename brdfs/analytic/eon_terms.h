// Terms of eon.h. Included by eon.cpp once for each instruction set.

#include <brdfs/analytic/eon_lobe.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

void evalEon(const EonShape& shape, const TermBatch& batch) {
    evalLanes<EonTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
