#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/light/lights.h>

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline irradiance {

/// Nine coefficients by channel, slot l(l+1)+m, real spherical harmonics without the
/// Condon-Shortley phase.
using NineRgb = std::array<Rgb, 9>;

/// Coefficients of irradiance E(n) = integral of L(w) max(0, n . w) d omega from the coefficients
/// of radiance: band l times pi, 2 pi / 3, pi / 4 (Ramamoorthi & Hanrahan 2001).
NineRgb irradianceOf(const NineRgb& radiance);

/// The sum of the nine functions at a unit vector.
Rgb evaluateNine(const NineRgb& coefficients, const Direction& normal);

/// Coefficients of the same function in other axes: f'(d) = f(axes^-1 d), where `axes` is
/// orthogonal, a reflection too. Exact.
NineRgb inAxes(const NineRgb& coefficients, const std::function<Direction(const Direction&)>& axes);

/// `count` normals of about equal solid angle (spherical Fibonacci lattice).
std::vector<Direction> normalLattice(std::size_t count);

/// Irradiance at each of many normals, [normal][R, G, B].
using Irradiances = std::vector<Rgb>;
Irradiances atNormals(std::span<const Direction> normals,
                      const std::function<Rgb(const Direction&)>& irradiance);

/// An approximation against direct integration over normals. Errors are divided by the mean
/// irradiance over normals and channels, so that no albedo is in them.
struct IrradianceErrors {
    double maximum = 0;   ///< the largest of any channel
    double mean = 0;      ///< of the absolute values, over normals and channels
    Direction worst;      ///< the normal of the maximum
    double negative = 0;  ///< the least approximation, if below 0, over the mean irradiance
};
IrradianceErrors errorsOf(std::span<const Direction> normals, const Irradiances& direct,
                          const Irradiances& approximation);

/// Mean over normals and channels.
double meanOf(const Irradiances& irradiances);

}  // namespace hshfit::inline irradiance
