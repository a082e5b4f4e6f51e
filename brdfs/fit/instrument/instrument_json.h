#pragma once

#include <brdfs/fit/instrument/fitted_instrument.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::brdfs {

/// The terms of an instrument in the report of a fit (docs/schemas/fit.schema.json).
nlohmann::ordered_json instrumentJson(const FittedInstrument& fitted);

}  // namespace hshfit::brdfs
