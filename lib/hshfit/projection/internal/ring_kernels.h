#pragma once

#include <cstddef>

namespace hshfit::inline projection {

/// Values at phi, pi - phi, -phi and pi + phi for `count` azimuths phi of the first quadrant,
/// folded into parts even (c) or odd (s) in phi, which keep (0) or change (1) their sign with pi -
/// phi, as cos(m phi) and sin(m phi) do for even and odd m: sums over a whole ring become four sums
/// over a quadrant. `c1` pairs with odd m, and so does `s1`.
struct QuadrantFold {
    double *c0, *c1, *s1, *s0;
};

/// Folds the four quadrants, each `count` values, one after the other from `values`, and returns
/// the sum of their squares.
double foldRing(const double* values, std::size_t count, const QuadrantFold& out);
/// The same for a ring that is even in phi, with values at phi and pi - phi only; `s1` and `s0` are
/// not written, and the sum of squares is over the half ring.
double foldHalfRing(const double* values, std::size_t count, const QuadrantFold& out);

/// A ring of clustered azimuths: values at phi and then at -phi, `count` each, into sums `even` and
/// differences `odd`; returns the sum of weight * value^2. Without `odd`, there are values at phi
/// only.
double foldSqueezedRing(const double* values, const double* weights, std::size_t count,
                        double* even, double* odd);

/// Directions of one ring. `fillRing`: quadrant after quadrant in the order of QuadrantFold, 4
/// copies, or 2 for half a ring; `cosine` and `sine` belong to the first quadrant's azimuths.
/// `fillSqueezedRing`: azimuths about the centre, then their mirror images, 2 copies,
/// or 1 for half a ring.
struct RingDirections {
    const double *cosine, *sine;
    std::size_t count, copies;
    double centreX, centreY;
};
void fillRing(const RingDirections& ring, double sinTheta, double cosTheta, double* x, double* y,
              double* z);
void fillSqueezedRing(const RingDirections& ring, double sinTheta, double cosTheta, double* x,
                      double* y, double* z);

/// Functions side by side, innermost in memory: as many as full vectors of every size take.
constexpr std::size_t lanesOfFunctions = 24;

/// `count` values of `functions` <= lanesOfFunctions rows, `stride` apart, to out[value][function];
/// 0 for functions that are missing. `next`, if any, are the rows of the following call, to
/// prefetch.
void interleaveFunctions(const double* rows, std::size_t functions, std::size_t stride,
                         std::size_t count, const double* next, double* out);
/// A whole ring, [azimuth][function], into the four sums of QuadrantFold, one after the other,
/// [kind][azimuth of the quadrant][function]. With a second ring, `sum` gets the even part (ring +
/// mirror) and `difference` the odd one.
void foldFunctions(const double* ring, const double* mirror, std::size_t azimuths, double* sum,
                   double* difference);

}  // namespace hshfit::inline projection
