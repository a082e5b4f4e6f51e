#include <brdfs/fit/column_products.h>

#define HWY_TARGET_INCLUDE "brdfs/fit/column_products_lanes.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(addProductsOf);

}  // namespace

void addProducts(const ColumnSpan& a, const ColumnSpan& b, std::size_t length, double* out,
                 std::size_t outStride) {
    HWY_DYNAMIC_DISPATCH(addProductsOf)(a, b, length, out, outStride, false);
}

void addGram(const ColumnSpan& a, std::size_t length, double* out, std::size_t outStride) {
    HWY_DYNAMIC_DISPATCH(addProductsOf)(a, a, length, out, outStride, true);
}

}  // namespace hshfit::brdfs
