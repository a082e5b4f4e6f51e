#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads ALTA's data files: a header of lines #KEY VALUE, of which
///     #DIM in out   #PARAM_IN NAME   #PARAM_OUT NAME   #VS k
/// count (PARAM_IN: alta_parameters.h), then rows of `in` coordinates, `out` values and the bounds
/// of vertical segments (#VS; not read). With #FORMAT binary the rows are doubles between
/// #BEGIN_STREAM and #END_STREAM, or without these marks after the last line with '#',
/// #SAMPLE_COUNT rows, #ENDIAN little or big.
/// Values are 1/sr; INV_STERADIAN_COSINE_FACTOR is divided by the cosine of the view direction;
/// XYZ_COLOR becomes linear Rec. 709. One value is grey, three are R, G, B.
/// Throws InputError, with `where` and the line or the sample, for any other content.
Samples readAlta(std::string_view text, const std::string& where);

/// Reads functions that ALTA fitted (#ALTA FUNC HEADER), whose sum is f, a value per channel:
///     nonlinear_function_diffuse  kd
///     nonlinear_function_blinn    Ks cos(theta_h)^N
///     nonlinear_function_abc      a / (1 + b (1 - x))^c, x of its #PARAM
///     nonlinear_function_spherical_gaussian  Ks exp(N (x - 1)), x by --sg-type of #CMD
///     nonlinear_fresnel_schlick   R + (1 - R)(1 - <h, wo>)^5, a factor of the function before it
///     rational_function           sum_i p_i prod_k u_k^deg / sum_j q_j prod_k u_k^deg, or
///     Legendre's
/// polynomials (#BASIS LEGENDRE), u_k = 2 (x_k - min_k)/(max_k - min_k) - 1, of the coordinates of
/// #PARAM_IN or, for a file that does not know them, of `input` (alta_coordinates.h).
/// Throws InputError for any other function, naming it.
std::unique_ptr<Brdf> readAltaFunction(std::string_view text, const std::string& where,
                                       std::string_view input = {});

/// The row of the table of formats.
const Format& altaFormat();

}  // namespace hshfit::brdfs
