#pragma once

#include <brdfs/fit/fit_result.h>

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// The laws of a fit as its preset has them, under fit.dispersion (docs/schemas/fit.schema.json).
nlohmann::ordered_json dispersionJson(const FitResult& result);

/// Opens a fit with laws over the wavelength at wavelengths of its band, "450/550/650" or
/// "FIRST:LAST:STEP", from the text of its preset. `where` starts every message. Throws UsageError
/// for wavelengths beyond the band, for wavelengths between the data's where a parameter has no
/// law, and for a preset without laws; InputError for invalid content.
std::unique_ptr<Brdf> openDispersed(std::string_view text, const std::string& where,
                                    std::string_view wavelengths);

}  // namespace hshfit::brdfs
