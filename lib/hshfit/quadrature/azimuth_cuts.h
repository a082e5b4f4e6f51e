#pragma once

#include <hshfit/brdf/kink_curve.h>
#include <hshfit/quadrature/azimuth_spread.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline quadrature {

/// Heights cos(theta) between which every curve either crosses all rings, always in the same order,
/// or none: where a curve touches a ring, ends, or meets another one about the same axis.
std::vector<double> curveEnds(const std::vector<KinkCurve>& curves);

/// The curves that cross the rings with u = sqrt(cos theta) in (a, b), which holds no curve's end.
struct PanelCurves {
    std::vector<KinkCurve> curves = {};
    /// Whether azimuths of crossings go like the square root of the distance from that end of the
    /// panel: a curve touches the ring there, or passes by the pole.
    bool rootAtA = false, rootAtB = false;

    PanelCurves() = default;
    PanelCurves(const std::vector<KinkCurve>& all, double a, double b);
    bool empty() const { return curves.empty(); }
};

/// The nodes of a ring that curves cross: a Gauss-Legendre rule on each piece of the half circle
/// between crossings, for azimuths above the centre of the spread and their mirror images. Nodes
/// crowd towards crossings at which f has a power of the distance that is no whole number.
class CutRing {
public:
    /// On the ring of this height and sine. `refinement` is 1 for the coarsest level.
    CutRing(const PanelCurves& curves, const AzimuthSpread& spread, double refinement,
            double height, double sine);

    /// Nodes of the half circle.
    std::size_t size() const { return size_; }
    /// t in (0, pi), before the spread's map, and weights that sum to pi.
    void nodes(std::vector<double>& t, std::vector<double>& weights) const;

private:
    struct Piece {
        double from, to;
        bool crowdFrom, crowdTo;
        std::size_t nodes;
    };
    std::vector<Piece> pieces_;
    std::size_t size_ = 0;
};

/// A point of [0, 1] as a function of one, and its slope, with a slope of 0 at the ends asked for.
struct Crowded {
    double at, slope;
};
Crowded crowded(double s, bool atFrom, bool atTo);

}  // namespace hshfit::inline quadrature
