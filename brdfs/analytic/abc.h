#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Two lobes with a power-law tail, after the ABC model of scatter from polished surfaces. Löw,
/// Kronander, Ynnerman & Unger 2012, 10.1145/2077341.2077350.
///     smooth      f = kd / pi + A F / (1 + B |D|^2)^C,  D = the projection of wi + wo on the
///                 surface: the deviation of wi from the mirror direction of wo
///     microfacet  f = kd / pi + A F G / (1 + B (1 - h.z))^C / (pi cos_i cos_o), G of V-shaped
///                 grooves, h normalised
/// F is the exact reflectance of a dielectric of index `ior` at (h.wo). A scales the lobe in 1/sr
/// and is no albedo: nothing is normalised. B ~ 1 / width^2, C: steepness of the tail.
/// The microfacet form is printed without 1 / pi; the published fits were made with it.
const Model& abcModel();

}  // namespace hshfit::brdfs
