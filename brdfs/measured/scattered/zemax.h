#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads tabular BSDF data of Zemax OpticStudio and Radiant's Imaging Sphere ("BSDF Data
/// Interchange file format", 2008; "Zemax Tabular BSDF data file format"): Source, Symmetry,
/// SpectralContent, ScatterType, and counts and lists of SampleRotation, AngleOfIncidence,
/// ScatterAzimuth and ScatterRadial in degrees, then for each rotation and incidence TIS and a row
/// of values for each azimuth.
///
/// Radial angles are from the specular direction s; azimuths turn about it from 0 towards the
/// normal, counterclockwise as seen against s. With s at azimuth 0 of the surface, u = (-cos A, 0,
/// sin A) towards the normal at an incidence of A:
///     wo = cos r s + sin r (cos a u + sin a s x u)
/// A rotation turns the sample counterclockwise. Values are f in 1/sr as they are: TIS, by which
/// OpticStudio scales each table, is not applied. Tristimulus X, Y, Z become linear Rec. 709, with
/// X = Y = Z grey. `zerosMeasured`: values of exactly 0 above the horizon are samples; the format
/// has no other mark for directions that were not measured. Throws InputError, with `where` and the
/// line, for other content.
///
/// With ScatterType BTDF, angles are about the direction of direct transmission. Mirrored at the
/// surface (hshfit/brdf/transmission.h) that is the specular direction, so that places are the
/// same; the fact `scatter_type` says which it is. Incidence is as for a pane between equal media.
Samples readZemax(std::string_view text, const std::string& where, bool zerosMeasured = false);

/// The directions of a place in such a table, in degrees.
DirectionPair zemaxPair(double rotation, double incidence, double azimuth, double radial);

/// The row of the table of formats.
const Format& zemaxFormat();

}  // namespace hshfit::brdfs
