#pragma once

#include <brdfs/fit/choose_parts.h>
#include <brdfs/fit/fit.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::brdfs {

/// The report in a preset file of a fit, beside the specification (docs/schemas/fit.schema.json):
/// method, parameters with errors, correlations, convergence, masked samples, statistics.
struct FitReport {
    std::string data;  ///< the specification that was fitted
    FitSamples const* samples = nullptr;
    FitOptions options;
    FitResult result;
    std::string sigma, scans;               ///< as they were stated
    FitSamples const* ofMetrics = nullptr;  ///< the samples that metrics are of
};

/// {"format": "hshfit-preset", …, "fit": {…}}: opened as a preset by every command. The same for
/// the same input, whatever the number of threads: without time.
nlohmann::ordered_json fitPreset(const FitReport& report);

/// The steps of a search for parts, in the form of the same schema.
nlohmann::ordered_json searchJson(const PartSearch& search);

}  // namespace hshfit::brdfs
