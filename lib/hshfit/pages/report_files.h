#pragma once

// The parts of writeReport, apart from the folder that they go to.

#include <hshfit/bases/catalog.h>
#include <hshfit/pages/report.h>

#include <string>
#include <vector>

namespace hshfit::inline pages {

/// curves.csv: report (from 1), basis, order, coefficients, slots, accuracy (empty where it does
/// not exist), then the texts quantity, outgoing, brdf.
std::string reportCsv(const Report& report);

/// curves.gp: draws the figures from curves.csv.
std::string reportScript(const Report& report);

/// report.html. `figures` holds an SVG document for each BRDF, or nothing at all.
std::string reportPage(const Report& report, const std::vector<std::string>& figures);

/// The specification on one line, printable, parameters with four digits, shortened in its middle
/// to `limit` bytes: for titles.
std::string shortName(const std::string& brdf, std::size_t limit);

/// The specification with files by their names alone: "lambert:kd=.1 + 0.5 * paint.bsdf" for a file
/// in any folder. A file is known by a '/' and an extension that begins with a letter.
std::string withoutFolders(const std::string& brdf);

/// "1.234 ± 1e-09", or "does not exist".
std::string energyText(const Energy& energy);

/// "θ = 52°, φ = 0°" and the like.
std::string outgoingText(const OutgoingSet& outgoing);

/// Whether any point of any curve has an accuracy.
bool hasAccuracy(const ReportEntry& entry);

/// Colour, dash and mark of a curve in figures and tables, of the wavelets too.
bases::Style curveStyle(const std::string& basis);

}  // namespace hshfit::inline pages
