#pragma once

#include "export.h"

#include <hshfit/wording.h>

#include <optional>
#include <string>

namespace hshfit::jobs {

ExportLoss exportLoss(const Brdf& source, const Representation& file, const Brdf& exported);

/// An export this many times as far from its source as its file is refused unless asked for.
inline constexpr double mostLoss = 2;
/// A mean log error below this is accepted from any file: float16 changes ln(1 + f) by no more.
inline constexpr double smallLoss = 0x1p-11;

/// Throws NumericError for an export that loses more than that. `cause`: the setting that would
/// have to go for a better one, if there is one.
void refuseLoss(const ExportLoss& loss, const std::string& path,
                const std::optional<Setting>& cause);

}  // namespace hshfit::jobs
