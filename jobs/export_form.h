#pragma once

#include "export.h"

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/forms/form_payload.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace hshfit::jobs {

/// Mean |ln(1 + f cos) - ln(1 + g cos)| over spreadPairs() against the BRDF that was projected, of
/// the coefficient file and of its export.
struct ExportLoss {
    std::size_t pairs = 0;
    double file = 0, exported = 0;
};
ExportLoss exportLoss(const Brdf& source, const Representation& file, const Brdf& exported);

/// An export this many times as far from its source as its file is refused unless asked for.
inline constexpr double mostLoss = 2;

/// Throws NumericError, with the call that does better, for an export that loses more than that.
void refuseLoss(const ExportLoss& loss, const std::string& path, const Setting& cause);

}  // namespace hshfit::jobs
