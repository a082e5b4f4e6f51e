#pragma once

#include <brdfs/fit/fit_json.h>
#include <hshfit/files/file_set.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The fit as the first section of the page in its folder, and its files.
struct FitSection {
    std::string html;
    std::vector<std::string> names;           ///< files in the set
    std::optional<std::string> undrawn = {};  ///< AddedFigures
};

/// Draws cuts, residuals, correlations and influence into `files`, beside parameters.tex and, of
/// measured samples, samples.csv, and writes the section: parameters with both uncertainties,
/// chi-square, budget, instrument, figures and the values that decide. `fit` is the part "fit" of
/// the preset (docs/schemas/fit.schema.json).
FitSection addFitSection(const brdfs::FitReport& report, const nlohmann::ordered_json& fit,
                         FileSet& files);

}  // namespace hshfit::jobs
