#pragma once

#include <brdfs/fit/fit.h>

#include <string>

namespace hshfit::jobs {

/// "kd is one number for all channels: WHY", where the data differ between channels by more than 1
/// % in their sums and the fit gives an albedo no value for each (brdfs::FreeParameter::albedo):
/// with terms of an instrument, under laws over the wavelength that do not name it, and in a model
/// that mixes channels. Else empty.
std::string greyColours(const brdfs::FitResult& result, const brdfs::FitSamples& samples,
                        const brdfs::FitOptions& options);

}  // namespace hshfit::jobs
