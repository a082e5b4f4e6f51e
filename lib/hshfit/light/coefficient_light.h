#pragma once

#include <hshfit/light/lights.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::inline light {

/// A light from a file of light coefficients (light_file.h), in the axes that the file states: the
/// world's axes, or the hemisphere's about its normal. Throws InputError as readLight does.
CoefficientLight readCoefficientLight(const std::string& path);
CoefficientLight coefficientLight(LightCoefficients coefficients, const std::string& file);

/// Whether a direction of the world belongs to the domain of the coefficients.
bool covers(const CoefficientLight& light, const Direction& world);

/// Radiance L = sum of c_{l,m} B_{l,m}, R, G, B, in a direction of the world; 0 beside the domain.
Rgb radianceOf(const CoefficientLight& light, const Direction& world);
/// The same in many directions, in one pass over the basis.
std::vector<Rgb> radianceOf(const CoefficientLight& light, const std::vector<Direction>& world);

/// Spherical harmonics of a light of the whole sphere for R, G, B, [channel][slot] of `order`
/// bands: cut off or filled with 0, turned and scaled with the light, exact but for rounding.
std::vector<double> harmonicsOf(const CoefficientLight& light, int order, bool condonShortley);

/// Exchanges y with -y in spherical harmonics, [channel][slot] of `order` bands: functions of
/// negative m change their sign.
void exchangeSides(int order, std::vector<double>& coefficients);

}  // namespace hshfit::inline light
