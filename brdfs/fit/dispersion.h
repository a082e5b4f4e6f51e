#pragma once

#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>

#include <string_view>

namespace hshfit::brdfs {

/// Whether a term of "a + b" names a metal in place of n and k (metal_spec.h).
bool namesMetals(std::string_view model);

/// One fit over all wavelengths of a spectrum, whose parameters follow laws over the wavelength
/// (FitOptions::dispersion, dispersion_law.h); shapes without a law are shared, linear parameters
/// have a value at each wavelength. Metals named in the model have their tabulated n and k.
///
/// Starts are the fits of single wavelengths, put under the laws, and the shapes of the first, the
/// middle and the last of them for all; the better two are searched from, over all
/// coefficients. Errors, covariance, chi-square and influence are computed as by fit(), in the
/// coefficients of the laws, and carried by the chain rule to the parameters that are reported.
/// Bootstrap draws start at the minimum.
///
/// Values are averaged over the instrument's apertures and slit, as in fitWithInstrument, and
/// a stated offset and dark signal are taken away; other terms of the instrument are refused with
/// UsageError.
///
/// Throws UsageError for data without wavelengths, for laws that the model does not take, and with
/// perChannel or a profile; NumericError as fit().
FitResult fitDispersed(const FitSamples& samples, const FitOptions& options);

}  // namespace hshfit::brdfs
