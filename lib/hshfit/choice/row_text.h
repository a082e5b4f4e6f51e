#pragma once

#include <hshfit/choice/rows.h>

#include <optional>
#include <string>

namespace hshfit::choice {

/// The commands that write a row, as one line of a shell; empty: there is no file to write.
std::string commandLineOf(const Row& row);

/// The cycles of a cost; "-": not known.
std::string cyclesText(const std::optional<gpu::ShaderCost>& cost);

/// A sentence without its point that says what cycles are.
std::string scaleText(const CostScale& scale);

}  // namespace hshfit::choice
