#pragma once

#include <brdfs/fit/fit.h>

#include <string>

namespace hshfit::cli {

/// The quadratures over apertures and the scales of scans, in lines; empty without an instrument.
std::string instrumentText(const brdfs::FitResult& result);

}  // namespace hshfit::cli
