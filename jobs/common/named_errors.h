#pragma once

#include <functional>
#include <string>

namespace hshfit::jobs {

/// Calls `work`. An Error about a BRDF, other than an OutputError, whose message does not name the
/// file that `spec` opens (a preset says its model) is thrown with that name before the message.
void withFileNamed(const std::string& spec, const std::function<void()>& work);

}  // namespace hshfit::jobs
