#pragma once

#include <brdfs/measured/scattered/chart.h>
#include <brdfs/measured/scattered/samples.h>

#include <cstddef>
#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// One of ALTA's parametrisations (#PARAM_IN; Belcour, Barla & Pacanowski, "ALTA: A BRDF Analysis
/// Library", 2014, and the comments of its core/params.h): V is the view, our wo, L the light, our
/// wi; H the half vector, K = V + mirrored(L) normalised, the back vector; angles in radians.
struct AltaParameters {
    std::string_view name;
    std::size_t count;  ///< numbers in a row
    Chart chart;        ///< of a row; Chart::isotropic: a pair but for its azimuth
    /// Finds the pair of a row, or one of the pairs that it stands for. False if there is none.
    bool (*directions)(const double* x, Direction& wi, Direction& wo);
    std::span<const char> kinds;  ///< of each number: a polar angle, an azimuth, a cosine, a length
};

/// Null for a name that is not ALTA's, and for one that gives neither a pair of directions nor
/// an angle that f could depend on.
const AltaParameters* altaParameters(std::string_view name);

/// The names that are read, in one line.
std::string_view altaParameterNames();

/// Checks the numbers of a row and finds its directions. Throws InputError.
void altaDirections(const AltaParameters& parameters, const double* x, const Row& row,
                    Direction& wi, Direction& wo);

}  // namespace hshfit::brdfs
