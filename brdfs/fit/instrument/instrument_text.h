#pragma once

#include <brdfs/fit/instrument/fitted_instrument.h>

#include <string>
#include <utility>
#include <vector>

namespace hshfit::brdfs {

/// The terms of an instrument for tables, each with its name and what is stated or fitted of it, in
/// the order of the formula in instrument.h.
std::vector<std::pair<std::string, std::string>> instrumentRows(const FittedInstrument& fitted);

}  // namespace hshfit::brdfs
