#pragma once

// The instruction sets that vector code is compiled for, and chosen from at run time (Google
// Highway); included before any of its headers. SSE4, AVX2 with FMA and AVX-512 on x86, NEON on
// Arm, and one value at a time for anything else. Left out are instruction sets that add nothing
// which this code uses, and sets whose vectors, of no length at compile time, cannot be kept in
// arrays or classes. A first build (HSHFIT_INSTRUCTION_SETS=own) has one, chosen when it is built
// (cmake/vector_sources.cmake), the sanitizers' the baseline and AVX2 (common) or AVX-512 (wide).
#ifdef HSHFIT_OWN_SET
#define HWY_COMPILE_ONLY_STATIC
#elif defined(HSHFIT_COMMON_SETS)
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)
#elif defined(HSHFIT_WIDE_SETS)
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3_DL)
#elif !defined(HWY_DISABLED_TARGETS)
#define HWY_DISABLED_TARGETS \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
