#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/projection/projection.h>
#include <hshfit/wavelets/slices.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline pages {

/// One truncation of one basis.
struct ReportPoint {
    int order = 0;
    int coefficients = 0;  ///< functions of the basis that can be non-zero
    int slots = 0;         ///< order^2
    /// Captured energy over energy (Gautron et al. 2004, Eq. 15); none where that does not exist.
    std::optional<double> accuracy;
};

struct ReportCurve {
    std::string basis;
    std::vector<ReportPoint> points;  ///< ascending order
    /// The energy in this basis' own inner product, where that is not the solid angle.
    std::optional<Energy> energy;
    /// The points keep the largest coefficients of each outgoing direction and channel instead of
    /// the first ones: a nonlinear approximation, which has to store their indices too.
    bool bestTerms = false;
    /// Relative, of the energies behind a curve of best terms.
    std::optional<double> error;
};

/// The curves of one BRDF.
struct ReportEntry {
    std::string brdf;
    Quantity quantity = Quantity::brdf;
    OutgoingSet outgoing;
    Channels channels;
    bool condonShortley = false;
    Energy energy;  ///< over solid angle; channels and outgoing directions summed
    std::vector<ReportCurve> curves;
    double error = 0;          ///< as in Coefficients; the largest of the bases
    std::string errorOf = {};  ///< the basis that has it; empty of a single basis
    double tolerance = 0;      ///< as in Coefficients
    std::size_t evaluations = 0;
    /// Where no basis captures `leastOfNeeds`: the call that captures more, if one is known.
    std::string better = {};
};

/// The least share of the energy for which a report states the coefficients that are needed.
inline constexpr double leastOfNeeds = 0.9;

/// Whether a curve that measures energy over solid angle reaches `leastOfNeeds`.
bool suffices(const ReportEntry& entry);

/// The content of a report: an entry for each BRDF.
struct Report {
    std::vector<ReportEntry> reports;
};

/// The curves of orders 1 to each projection's order. `projections` are one BRDF's, not empty.
ReportEntry reportEntry(std::span<const Projection> projections);

/// The curve of spherical wavelets: point n keeps n^2 terms, as many as order n of a basis has
/// slots, for n = 1 .. maxOrder. `slices` has as many; none: the energy does not exist.
ReportCurve waveletCurve(const wavelets::SliceCurve* slices, const Energy& energy, int maxOrder);

/// The first point whose accuracy is at least `accuracy`; none if the curve does not get there.
std::optional<ReportPoint> firstReaching(const ReportCurve& curve, double accuracy);

/// The document of `report --json` (docs/schemas/report.schema.json), with a line feed at the end.
std::string reportJson(const Report& report);

/// Writes curves.csv, report.json, curves.gp, curves.svg, curves.pdf and report.html to `folder`,
/// which is made if it is absent (its parent is not). They appear together or not at all; the same
/// report gives the same bytes. The figures are drawn by gnuplot. Throws OutputError where a file
/// cannot be written or a figure is cut short; also NoFigures where gnuplot is missing or fails,
/// and then everything but curves.svg and curves.pdf has been written.
void writeReport(const Report& report, const std::string& folder);

}  // namespace hshfit::inline pages
