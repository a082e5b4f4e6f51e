// Compiles the formulas in HWY_TARGET_INCLUDE for every instruction set that is chosen from at run
// time (Google Highway). A model defines that name before it includes this file, and evaluates
// through HWY_DYNAMIC_DISPATCH:
//
//     #define HWY_TARGET_INCLUDE "brdfs/analytic/ward_terms.h"
//     #include <brdfs/lanes/each_target.h>
//
// Of x86 these are SSE4, AVX2 and AVX-512, of Arm NEON. SSSE3 has too few users to compile for, and
// vectors of SVE, whose size no compiler knows, cannot be members of a class (lanes.h).

#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
#include <hwy/foreach_target.h>
#include HWY_TARGET_INCLUDE
