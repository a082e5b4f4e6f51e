#pragma once

#include <hshfit/light/internal/hosek_wilkie_tables.h>
#include <hshfit/light/lights.h>

#include <span>

namespace hshfit::inline light {

/// One channel or wavelength of the sky of Hosek and Wilkie for one turbidity, albedo and sun.
/// `shape` has A B C D E F G I H of the formula, the order of the authors' tables; `colour` is
/// linear Rec. 709 where the formula is 1.
struct HosekWilkieTerm {
    std::array<double, HosekWilkieChannel::coefficients> shape{};
    Rgb colour{};
};

/// The sky of Hosek and Wilkie 2012 ("An Analytic Model for Full Spectral Sky-Dome Radiance", ACM
/// TOG 31(4)) without the disc of the sun. With theta from the zenith and gamma from the sun,
///     F = (1 + A exp(B / (cos theta + 0.01))) (C + D exp(E gamma) + F cos^2 gamma
///         + G chi(H, gamma) + I cos^1/2 theta),
///     chi = (1 + cos^2 gamma) / (1 + H^2 - 2 H cos gamma)^3/2,
/// times a radiance. All ten are Bezier curves of degree 5 in (elevation / 90 degrees)^1/3 and
/// linear between the tables' albedos 0 and 1 and turbidities 1 to 10. A sum of such terms for R G
/// B, X Y Z or wavelengths makes a colour, whose components below 0 count as 0.
///
/// The unit is 1000 cd/m^2, as the authors give it: X Y Z are W/m^2/sr, to be taken times 683 lm/W,
/// and wavelengths W/m^2/sr/nm. For RGB they give no unit: it is taken to be the same as for X Y Z.
/// Wavelengths become X Y Z by `tristimulusOfRadiance`.
///
/// Domain: turbidity 1 to 10, albedo 0 to 1 of the ground, sun.z >= 0. `file` names the tables:
/// throws InputError where they give radiance beyond 1e9, or infinite.
SkyLight hosekWilkieSky(const HosekWilkieTables& tables, const std::string& file, double turbidity,
                        double albedo, const Direction& sun);

/// The colour of the sum of the terms, `cosTheta` at least 0 and `gamma` in radians.
Rgb hosekWilkieColour(std::span<const HosekWilkieTerm> terms, double cosTheta, double gamma);

}  // namespace hshfit::inline light
