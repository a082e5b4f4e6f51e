#pragma once

#include <brdfs/fit/fit.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::brdfs {

/// What a preset file of a fit says beside the specification, docs/schemas/fit.schema.json: how it
/// was made, parameters with errors, correlations, convergence, what was masked, statistics.
struct FitReport {
    std::string data;  ///< the specification that was fitted
    FitSamples const* samples = nullptr;
    FitOptions options;
    FitResult result;
};

/// {"format": "hshfit-preset", …, "fit": {…}}: opened as a preset by every command. The same for
/// the same input, whatever the number of threads: without time.
nlohmann::ordered_json fitPreset(const FitReport& report);

}  // namespace hshfit::brdfs
