#pragma once

#include <hshfit/material_library/library.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::jobs {

/// The object "material" of answers and pages: name, source, kind, channels, bytes, errors and the
/// reason of a form of its own.
nlohmann::ordered_json materialJson(const material_library::Material& material);

}  // namespace hshfit::jobs
