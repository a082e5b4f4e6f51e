#pragma once

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/samples.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads ALTA's data files: a header of lines #KEY VALUE, of which
///     #DIM in out   #PARAM_IN NAME   #PARAM_OUT NAME   #VS k
/// count (PARAM_IN: alta_parameters.h), then rows of `in` coordinates, `out` values and the bounds
/// of vertical segments (#VS; not read). With #FORMAT binary the rows are doubles between
/// #BEGIN_STREAM and #END_STREAM, #SAMPLE_COUNT rows, #ENDIAN little or big.
/// Values are 1/sr; INV_STERADIAN_COSINE_FACTOR is divided by the cosine of the view direction;
/// XYZ_COLOR becomes linear Rec. 709. One value is grey, three are R, G, B.
/// Throws InputError, with `where` and the line or the sample, for any other content.
Samples readAlta(std::string_view text, const std::string& where);

/// Reads a function that ALTA fitted (#ALTA FUNC HEADER): sums of nonlinear_function_diffuse,
/// f = kd, and nonlinear_function_blinn, f = Ks cos(theta_h)^N, a value per channel.
/// Throws InputError for any other function, naming it.
std::unique_ptr<Brdf> readAltaFunction(std::string_view text, const std::string& where);

/// The row of the table of formats.
const Format& altaFormat();

}  // namespace hshfit::brdfs
