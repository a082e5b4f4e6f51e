#pragma once

#include <hshfit/accuracy/metrics.h>
#include <hshfit/files/file_set.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/pictures/sphere.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline pages {

struct ComparisonOptions {
    /// Directions of the metrics. None: 16 elevations, or a 16x16 map if one of the two is
    /// anisotropic. For a single direction, the plane of incidence is drawn at it alone.
    std::optional<OutgoingSet> outgoing = {};
    /// Metrics that were computed before, over `outgoing`; empty: all of the catalog are computed.
    std::vector<MetricValue> metrics = {};
    std::optional<PictureError> picture = {};  ///< to be shown first; none: left out
    SphereOptions sphere = {};
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// f of both along one line: [channel][angle], the drawn channels. Angles are in degrees.
struct ComparisonCurve {
    double azimuth = 0;  ///< of the outgoing direction, or of the half vector
    double slice = 0;    ///< the fixed angle, theta_o or theta_d; 0 for albedos
    std::vector<double> angles;
    std::vector<std::vector<double>> reference, approximation;
};

/// log10(approximation / reference), means over channels, at phi_d = 90 degrees, where both
/// directions are above the horizon for all theta_h and theta_d.
struct ResidualMap {
    double azimuth = 0;             ///< phi_h in degrees
    std::vector<double> thetaHalf;  ///< degrees; the squares of equispaced numbers
    std::vector<double> thetaDifference;
    std::vector<double> logRatio;  ///< [thetaDifference][thetaHalf]; NaN where one is not > 0
    std::vector<unsigned char> measured;  ///< whether the reference rests on samples there
};

struct ComparedBrdf {
    std::string name;
    Channels channels;
    Laws laws;
    double albedoError = 0;     ///< of the albedos that are drawn
    std::size_t notFinite = 0;  ///< values left out of albedos and sphere
};

/// Everything that the page shows.
struct Comparison {
    ComparedBrdf reference, approximation;
    OutgoingSet outgoing;
    std::vector<MetricValue> metrics;
    std::optional<PictureError> picture = {};
    Channels channels;               ///< of the comparison: of the BRDF with more
    std::vector<std::size_t> drawn;  ///< of these, at most 4
    /// f(theta_i) in the plane of incidence; negative angles on the side of the outgoing direction.
    std::vector<ComparisonCurve> polar;
    /// f(theta_h) at phi_d = 90.
    std::vector<ComparisonCurve> half;
    /// Directional albedo over theta_o.
    std::vector<ComparisonCurve> albedo;
    std::vector<ResidualMap> residuals;  ///< one per azimuth: 0, and 90 unless both are isotropic
    SphereRig rig;
    SpherePicture referenceSphere, approximationSphere, difference;
    double stops = 0;          ///< exposure of the spheres, from the reference
    double amplification = 1;  ///< of the difference that is shown
};

/// The channels that figures show: all of up to four; else those nearest to 450, 550 and 650 nm, or
/// first, middle and last where these are outside of the range.
std::vector<std::size_t> drawnChannels(const Channels& channels);

/// Samples both and computes everything that the page shows. A grey BRDF compares with any
/// channels; otherwise the channels have to agree (UsageError).
Comparison makeComparison(const Brdf& reference, const Brdf& approximation,
                          const ComparisonOptions& options = {});

/// Writes comparison.html (self-contained), comparison.json, polar.csv, half.csv, residual.csv,
/// albedo.csv, spheres.png, spheres.exr (linear; the third is approximation - reference),
/// comparison.gp and the figures that it draws, polar-A.svg, half-A.svg and residual-A.svg for each
/// azimuth A, to `folder`, which is made if it is absent (its parent is not). They appear together
/// or not at all; the same comparison gives the same bytes. Returns the names of the files. Throws
/// OutputError where a file cannot be written or a figure is cut short; also NoFigures where
/// gnuplot is missing or fails, and then everything but the .svg files has been written.
std::vector<std::string> writeComparison(const Comparison& comparison, const std::string& folder);

/// The files of a comparison in a set with others, which is yet to be committed, and why figures
/// are not among them. `opening` is HTML of the caller, sections in front of the page's.
struct AddedComparison {
    std::vector<std::string> names;
    std::optional<std::string> undrawn;
};
AddedComparison addComparison(const Comparison& comparison, FileSet& files,
                              const std::string& opening = {});

/// Compares and writes in one call. The folder is made before the work: a folder that cannot be
/// made costs nothing.
std::vector<std::string> writeComparison(const Brdf& reference, const Brdf& approximation,
                                         const ComparisonOptions& options,
                                         const std::string& folder);

}  // namespace hshfit::inline pages
