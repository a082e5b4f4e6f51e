#pragma once

namespace hshfit::brdfs {

/// The exponent of Charlie's distribution, and the coefficients of the authors' fit of Lambda
/// (charlie.h), which are mixed from their table for r = 0 and r = 1.
template <class N>
struct CharlieCurve {
    N power, a, b, c, d, e;
};

}  // namespace hshfit::brdfs
