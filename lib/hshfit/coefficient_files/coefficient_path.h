#pragma once

#include <string>

namespace hshfit::inline coefficient_files {

/// Throws UsageError where the extension is that of no coefficient file: a check before the work,
/// which writeCoefficients repeats.
void requireCoefficientPath(const std::string& path);

}  // namespace hshfit::inline coefficient_files
