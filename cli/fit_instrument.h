#pragma once

#include <brdfs/fit/fit.h>

#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// The options of `fit` about the instrument that took the samples.
void addInstrumentOptions(CLI::App& command, brdfs::InstrumentText& instrument);

/// The quadratures over apertures and the scales of scans, in lines; empty without an instrument.
std::string instrumentText(const brdfs::FitResult& result);

}  // namespace hshfit::cli
