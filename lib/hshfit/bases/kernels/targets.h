#pragma once

// Included before any header of Highway: the instruction sets that kernels are compiled for are
// SSE4, AVX2 with FMA and AVX-512 on x86, NEON on ARM, and one value at a time for anything else.
// Left out are those that add nothing which these kernels use, and those whose vectors have no
// length at compile time.
#define HWY_DISABLED_TARGETS \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
