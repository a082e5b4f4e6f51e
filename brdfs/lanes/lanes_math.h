// Elementary functions of Lanes (lanes.h), and of double from the C++ library under the same names.
// Compiled once for each instruction set. `tests/brdfs/lanes_test.cpp` holds them to these bounds
// against the library, of the arguments that models have; in units of the last place, with fused
// multiply-adds and without:
//     exp        1.5  for x <= 709.78; beyond, infinity; 0 below -707 instead of down to 5e-324
//     log        1.0  for x > 0, subnormal numbers included
//     log1p      3.0  for x > -1; the sum 1 + x is rounded, unless it is near 1
//     expm1      3.0  for x <= 709.78
//     pow        exp(y log x): 1.5 + 2 |y log x|, for x >= 0
//     erfc       4 + x^2 for 0 <= x <= 7; beyond, erfc(7) = 4e-23
//     ierfc      no bound of its own: within 1e-15 of the exact value for x >= 0
// NaN does not stay NaN.

#if defined(BRDFS_LANES_LANES_MATH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_MATH_H
#undef BRDFS_LANES_LANES_MATH_H
#else
#define BRDFS_LANES_LANES_MATH_H
#endif

#include <brdfs/lanes/lanes_exp.h>
#include <brdfs/lanes/lanes_log.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

HWY_INLINE Lanes pow(Lanes x, Lanes y) {
    const Lanes power = exp(y * log(x));
    const auto zero = x < Lanes(5e-324);
    if (!anyOf(zero)) return power;
    const Lanes inf = std::numeric_limits<double>::infinity();
    return select(zero, select(y > Lanes(0.0), 0.0, select(y < Lanes(0.0), inf, 1.0)), power);
}
HWY_INLINE double pow(double x, double y) {
    return std::pow(x, y);
}

HWY_INLINE double erfc(double x) {
    return std::erfc(x);
}

/// As ierfc below: exp(-x^2)/(1 + x) times a polynomial in t = (x - 3)/(x + 3), which has the
/// values of (1 + x) exp(x^2) erfc(x) at Chebyshev's nodes of 0 <= x <= 7.
HWY_INLINE Lanes erfc(Lanes x) {
    constexpr double c[] = {
        0.716004604725559712,    -0.230927333083807806,     0.0990207536794738968,
        -0.0102353888991968331,  -0.0238039131113514831,    0.0219577640182659142,
        -0.00975068920933819423, 0.00161856911067820275,    0.00064581296721022397,
        -0.00036728981701312721, -0.0000205429926197742085, 0.0000561388927705667873,
        -1.53252518343489162e-6, -9.08955110002711632e-6,   1.87110263291484882e-7,
        1.72451128113540511e-6,  3.61718879988453458e-7,    -8.32540888080551914e-8,
        -3.04351050883187469e-8};
    const Lanes y = min(x, 7.0);
    const Lanes beyond = y + 3.0, t = (y - 3.0) / beyond, t2 = t * t;
    Lanes even = c[18], odd = c[17];
    for (int i = 16; i >= 0; i -= 2) even = fused(even, t2, c[i]);
    for (int i = 15; i >= 1; i -= 2) odd = fused(odd, t2, c[i]);
    return exp(-(y * y)) * fused(odd, t, even) / (y + 1.0);
}

/// The integral of erfc from x on: exp(-x^2)/sqrt(pi) - x erfc(x).
HWY_INLINE double ierfc(double x) {
    return x < 27 ? std::exp(-x * x) * std::numbers::inv_sqrtpi - x * std::erfc(x) : 0;
}

/// exp(-x^2)/(1 + x)^2 times a polynomial in t = (x - 2.5)/(x + 2.5), which has the values of
/// (1 + x)^2 exp(x^2) ierfc(x) at Chebyshev's nodes of 0 <= x <= 7.
HWY_INLINE Lanes ierfc(Lanes x) {
    constexpr double c[] = {
        0.455377499087492933,     -0.226373752736306954,    0.0145395268738964978,
        0.084962736571938857,     -0.0588159341143043001,   0.00445803592461099473,
        0.013628844417130513,     -0.00510891470600753589,  -0.00187709452585626029,
        0.00122555934942836496,   0.000369111430180913346,  -0.000249201659289516099,
        -0.000104973077066416604, 0.0000419589564006362401, 0.0000327865145393798987,
        -1.80641380860952923e-6,  -8.53254147030418974e-6,  -3.46045703729615913e-6,
        -4.95686857997891977e-7};
    const Lanes y = min(x, 7.0);
    const Lanes beyond = y + 2.5, above = y + 1.0;
    const Lanes t = (y - 2.5) / beyond, t2 = t * t;
    Lanes even = c[18], odd = c[17];
    for (int i = 16; i >= 0; i -= 2) even = fused(even, t2, c[i]);
    for (int i = 15; i >= 1; i -= 2) odd = fused(odd, t2, c[i]);
    return exp(-(y * y)) * fused(odd, t, even) / (above * above);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
