#pragma once

#include <brdfs/fit/fit_json.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::jobs {

/// A table as texts: of the same number of columns in the head and in each row.
struct TextTable {
    std::vector<std::string> heads;
    std::vector<std::vector<std::string>> rows;
};

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// The model, data, samples, chi-square with its probability, residual and share explained; `fit`
/// is the part "fit" of the preset (docs/schemas/fit.schema.json), here and below.
NamedTexts fitFacts(const brdfs::FitReport& report, const nlohmann::ordered_json& fit);

/// Parameters with standard and expanded uncertainties, k and degrees of freedom, but scales of
/// scans; with `routes` a column for the errors by each route too.
TextTable parameterTable(const brdfs::FitReport& report, const nlohmann::ordered_json& fit,
                         bool routes);
/// The words of its columns.
std::string parameterLegend(const brdfs::FitReport& report);

/// The sets of parameters that the data do not tell apart, "a, b" each. A single parameter that is
/// not determined is in no set: the row of the parameter says it.
std::vector<std::string> notToldApart(const brdfs::FitResult& result);

/// The budget: its contributions parameter by parameter, each with the combined and the expanded
/// uncertainty at its end. Empty without one.
TextTable budgetTable(const brdfs::FitResult& result);

/// At most `most` values with the largest Cook's distances. Empty without a study.
TextTable influenceTable(const nlohmann::ordered_json& fit, std::size_t most);
/// The number of outliers and the bound that makes them; empty without a study.
std::string outlierText(const nlohmann::ordered_json& fit);

}  // namespace hshfit::jobs
