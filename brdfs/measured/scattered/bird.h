#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads the universal BRDF file format of the project BiRD (EMPIR 16NRM08), JSON by the schema
/// `brdf_json_schema_v1.0.json` of github.com/BiRD-project/BiRD_view. `data` has lists of one
/// length: theta_i, phi_i, theta_r, phi_r ("deg", "°" or "rad") and BRDF (1/sr), with
/// wavelength_i or wavelength_r ("nm" or "μm"), polarization_i ("sp" or intensity-normalised Stokes
/// vectors) and uBRDF where given. Rows that differ by the polarization of the light alone become
/// their mean, whose Stokes vectors have to cancel, which is unpolarised light; wavelengths become
/// channels. uBRDF, or the constant uncertainty of BRDF, is taken as standard uncertainty.
///
/// Throws InputError, with `where` and the field, for other content, polarised light alone, and
/// values seen through an analyser (polarization_r other than "u").
Samples readBird(std::string_view text, const std::string& where);

/// The row of the table of formats.
const Format& birdFormat();

}  // namespace hshfit::brdfs
