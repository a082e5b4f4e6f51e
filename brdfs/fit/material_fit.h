#pragma once

#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>

namespace hshfit::brdfs {

/// The fit of a material alone: fit() without laws over the wavelength, metals and terms of the
/// instrument, of statements that fit() has checked. Fits with an instrument begin with it, without
/// albedos of each channel (`coloured`: ParametricSum).
///
/// Throws UsageError for the model and for values to start from of another number than its shapes;
/// NumericError if there are fewer values than parameters.
FitResult fitMaterial(const FitSamples& samples, const FitOptions& options, bool coloured = true);

}  // namespace hshfit::brdfs
