#pragma once

#include <brdfs/measured/scattered/alta_parameters.h>

#include <cstddef>
#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// The coordinates of a pair of directions in one of ALTA's parametrisations, for the functions
/// that ALTA fits over them: the inverse of AltaParameters::directions.
struct AltaCoordinates {
    std::string_view name;
    std::size_t count;
    bool reciprocal;       ///< unchanged when wi and wo are exchanged
    bool isotropic;        ///< unchanged when both turn about the normal
    bool mirrorSymmetric;  ///< unchanged when both are mirrored at a plane through the normal
    /// From unit vectors above the horizon, angles in radians; azimuths of differences are from 0
    /// to 2 pi.
    void (*coordinates)(const Direction& wi, const Direction& wo, double* x);
};

/// Null for a name without coordinates of a pair.
const AltaCoordinates* altaCoordinates(std::string_view name);

std::span<const AltaCoordinates> allAltaCoordinates();

/// The names that are known, separated by commas.
std::string_view altaCoordinateNames();

}  // namespace hshfit::brdfs
