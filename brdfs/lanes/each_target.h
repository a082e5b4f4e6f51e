// Compiles the formulas in HWY_TARGET_INCLUDE for every instruction set that is chosen from at run
// time (Google Highway). A model defines that name before it includes this file, and evaluates
// through HWY_DYNAMIC_DISPATCH:
//
//     #define HWY_TARGET_INCLUDE "brdfs/analytic/ward_terms.h"
//     #include <brdfs/lanes/each_target.h>

#include <hshfit/vector_targets.h>

#include <hwy/foreach_target.h>
#include HWY_TARGET_INCLUDE
