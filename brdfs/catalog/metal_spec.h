#pragma once

#include <hshfit/brdf/brdf.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// Help on metals in place of n and k, for listings.
inline constexpr std::string_view metalHelp =
    "metal=NAME in place of fresnel, ior and k: tabulated n and k (list metals), seen as RGB under "
    "D65; with nm=450/550/650 or nm=FIRST:LAST:STEP a spectral BRDF";

/// Whether "key=value,…" of a model names a metal.
bool namesMetal(std::string_view values);

/// "MODEL[:key=value,…]" at one wavelength: metal=NAME becomes fresnel=conductor, ior and k there.
/// A specification without a metal is returned as it is. Throws UsageError for a model without ior
/// and k, for an ior or k stated beside a metal, and beyond the metal's table.
std::string atWavelength(std::string_view spec, double nanometres);

/// Opens "MODEL:…,metal=NAME[,nm=…]": the model at each of these wavelengths as a spectral BRDF;
/// without nm at 380 to 780 nm by 5 nm as linear Rec. 709 (asRgb), exactly the CIE's sums, because
/// f is taken at every node of theirs. Colours have to be single values. Throws UsageError.
std::unique_ptr<Brdf> openMetal(std::string_view spec);

/// "450/550/650" or "FIRST:LAST:STEP": ascending, at least one and at most 1000. `what` starts
/// messages. Throws UsageError.
std::vector<double> wavelengthsIn(std::string_view text, std::string_view what);

}  // namespace hshfit::brdfs
