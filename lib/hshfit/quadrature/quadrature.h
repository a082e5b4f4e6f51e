#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/quadrature/azimuth_cuts.h>
#include <hshfit/quadrature/azimuth_spread.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline quadrature {

/// Nodes, ascending, and weights of a Gauss-Legendre rule on [-1, 1].
struct GaussRule {
    std::vector<double> nodes, weights;
};

/// The n-point rule, computed by Newton steps in theta on the Legendre recurrence in differences,
/// in extended precision: nodes within 1 ulp, weights within a few, for n from 1 to many thousands
/// (O(n^2) work once; cached for the life of the process). Safe from many threads.
/// Throws UsageError unless 1 <= n <= 100000.
const GaussRule& gaussLegendre(int n);

/// Rings of constant elevation, in groups that share their azimuths or are cut by the same curves.
/// The integral of q over the hemisphere is the sum over rings of
///     weight * (2 pi / azimuths) * (sum over the ring's azimuths of q d phi / dt),
/// and on a ring that is cut weight * (sum over nodes and their mirror images of their weights
/// times q d phi / dt).
struct HemisphereGrid {
    struct Panel {
        std::size_t firstRing = 0, rings = 0;
        AzimuthSpread azimuths = {};
        bool crowded = false;            ///< rings crowd towards an end of the panel
        std::vector<CutRing> cuts = {};  ///< of each ring, where curves cross the panel
        std::size_t points() const;
    };
    std::vector<Elevation<double>> elevations;  ///< per ring
    std::vector<double> sines;                  ///< sin(theta) per ring
    std::vector<double> weights;                ///< d mu per ring; they sum to 1
    std::vector<Panel> panels;

    std::size_t points() const;
    void clear();  ///< keeps the allocated memory
};

struct GridOptions {
    int order = 7;  ///< bands that have to be resolved exactly
    /// Refinement: every level has 1.4 times as many nodes, in both directions. Isotropic lobes are
    /// right to about 1e-3 at level 0 and to 1e-6 at level 2, long and narrow ones two levels
    /// later. Levels below 0 are for tolerances that level 0 exceeds.
    int level = 0;
    /// Whether azimuths may be clustered; if not, all panels have equispaced ones.
    bool squeezed = false;
    bool even = false;  ///< only about a centre on the x axis
};

/// Ends of the elevation panels, in u = sqrt(cos theta) from 0 to 1, for a BRDF with these lobes.
/// Each lobe is taken as a complex singularity at its width's distance from the real axis; panels
/// are halved until it lies outside a fixed Bernstein ellipse of each, so that a lobe of width w
/// costs O(log 1/w) panels. Panels also end at the heights cos(theta) of `kinks`.
std::vector<double> panelBreaks(const std::vector<Lobe>& lobes, const Direction& wo,
                                const std::vector<double>& kinks = {});

/// Adds the panel [a, b] in u: Gauss-Legendre rings times azimuths, whose number and clustering
/// follow from the singularities along phi (azimuth_spread.h). In u, functions that behave like
/// sqrt(cos theta) at the horizon are smooth. Rings that curves cross have nodes between them.
void appendPanel(HemisphereGrid& grid, double a, double b, const AzimuthPeaks& peaks,
                 const GridOptions& options, const PanelCurves& curves = {});

/// All panels at one level: a grid for integrands made of a BRDF with these lobes, kinks and kink
/// curves at `wo`, its square, and basis functions.
HemisphereGrid gridFor(const std::vector<Lobe>& lobes, const Direction& wo,
                       const GridOptions& options, const std::vector<double>& kinks = {},
                       const std::vector<KinkCurve>& curves = {});

}  // namespace hshfit::inline quadrature
