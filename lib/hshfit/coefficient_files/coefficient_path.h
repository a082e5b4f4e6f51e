#pragma once

#include <string>

namespace hshfit::inline coefficient_files {

/// Throws UsageError where no coefficient file has this extension: a check before the work,
/// which writeCoefficients repeats.
void requireCoefficientPath(const std::string& path);

}  // namespace hshfit::inline coefficient_files
