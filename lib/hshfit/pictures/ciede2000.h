#pragma once

#include <hshfit/pictures/lab.h>

namespace hshfit::inline pictures {

/// The colour difference CIEDE2000 with kL = kC = kH = 1, by the formulas of Sharma, Wu & Dalal
/// 2005 (10.1002/col.20070): 0 for equal colours, about 1 where a difference is just seen.
/// Symmetric. Any L*a*b*; it was made for differences of at most 5.
double ciede2000(const Lab& x, const Lab& y);

}  // namespace hshfit::inline pictures
