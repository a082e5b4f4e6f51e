#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/tradeoff/tradeoff.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::tradeoff {

/// Writes to `folder`, made if absent, the files of a trade:
///     tradeoff.json, forms.csv, front.csv, tradeoff.gp, front.svg, tradeoff.html
/// which are the same bytes whenever the same trade is measured, and, if it was timed, the files
/// that hold times:
///     timing.json, timing.csv, timing_front.csv, timing.svg, timing.html
/// and timing_gpu.csv where shaders were timed.
/// They appear together or not at all. Throws OutputError where a file cannot be written or a
/// figure is cut short; also NoFigures where gnuplot is missing or fails, and then everything but
/// the figures has been written.
void writeTradeoffs(std::span<const Tradeoff> trades, const std::string& folder);
/// The same to the folder of a set, which may hold other files already, and commits it.
void writeTradeoffs(std::span<const Tradeoff> trades, FileSet& files);

/// The document of tradeoff.json (docs/schemas/tradeoff.schema.json), with a line feed at the end.
/// With `timing`, the document of timing.json is its member "timing", for a single document.
std::string tradeoffJson(std::span<const Tradeoff> trades, bool timing = false);
std::string timingJson(std::span<const Tradeoff> trades);

/// Every form: brdf (from 1), series (as in the figures), bytes, error, uncertainty, one column per
/// band, entropy_bytes, numbers, one column per metric, front (1 or 0), options.
std::string formsCsv(std::span<const Tradeoff> trades);
/// The points of the front by rising bytes: brdf, bytes, error, knee (1 or 0), command.
std::string frontCsv(std::span<const Tradeoff> trades);
/// Every form: brdf, series, batch_ns, error, quartiles, the same of single pairs, seconds of
/// projection and derivation, bytes, front, options.
std::string timingCsv(std::span<const Tradeoff> trades);
/// As frontCsv, by rising nanoseconds.
std::string timingFrontCsv(std::span<const Tradeoff> trades);

/// The shaders of the forms of the fronts: brdf, ns_per_million_pixels, quartiles, the median time
/// of the shader without a form, error, bytes, device, software (1 or 0), options.
std::string shadersCsv(std::span<const Tradeoff> trades);

/// Draws front.svg from forms.csv and front.csv, and timing.svg where there is a timing.csv.
std::string tradeoffScript(std::span<const Tradeoff> trades);

/// tradeoff.html and timing.html. `figures` holds an SVG document for each BRDF, or nothing.
std::string tradeoffPage(std::span<const Tradeoff> trades, const std::vector<std::string>& figures);
std::string timingPage(std::span<const Tradeoff> trades, const std::vector<std::string>& figures);

/// The text that the program prints: the front of one BRDF, its knee and the forms left out.
std::string tradeoffText(const Tradeoff& trade, bool byTime);

/// The call that makes the form, as messages name it (wording.h).
std::string commandOf(const Tradeoff& trade, std::size_t form);

/// The groups in which figures show forms, from 1: "outgoing", "outgoing, factored", "basis",
/// "basis, factored", "halfway".
std::span<const char* const> seriesNames();
std::size_t seriesOf(const Form& form);

/// The least error of the forms of one kind within a budget; none if no form of the kind is.
std::optional<std::size_t> bestWithin(const Tradeoff& trade, Representation::Kind kind,
                                      std::size_t bytes);

/// The metric and the weights of the fronts in words: "mean |ln(1 + f c) - ln(1 + g c)| (nbrdf)".
std::string metricText(const std::string& metric);

}  // namespace hshfit::tradeoff
