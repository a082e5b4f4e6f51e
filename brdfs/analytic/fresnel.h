#pragma once

namespace hshfit::brdfs {

// Reflectance of a smooth boundary for unpolarised light: Fresnel's equations as in Born & Wolf,
// "Principles of Optics", 7th ed., 1999, 1.5.2 and 14.2. `cosine` is of the angle of
// incidence, in [0, 1]; n = eta + i k, eta > 0, k >= 0, is the index beyond the boundary over the
// index on the side of the light. Results lie in [0, 1] and are never NaN for arguments in these
// ranges, 1 and the horizon included. Their relative accuracy is the accuracy of eta - 1.

/// Mean of the reflectances along and across the plane of incidence:
///     R_s = |(c - g)/(c + g)|^2,  R_p = R_s |(c g - s^2)/(c g + s^2)|^2,  g^2 = n^2 - s^2.
/// eta >= 1: below 1 for every c > 0. eta < 1 (from the denser side): 1 from the critical angle,
/// sin = eta, on.
double dielectricReflectance(double cosine, double eta);

/// The mean reflectance of an absorbing medium; k = 0 is the dielectric.
double conductorReflectance(double cosine, double eta, double k);

/// ((eta - 1)^2 + k^2)/((eta + 1)^2 + k^2), which both have at cosine 1.
double normalReflectance(double eta, double k = 0);

/// eta >= 1 of the dielectric with this reflectance at normal incidence; f0 in [0, 1).
double iorOfReflectance(double f0);

/// Schlick's (1 - cosine)^5, the weight of 1 - f0: Schlick 1994, 10.1111/1467-8659.1330233.
inline double schlickWeight(double cosine) {
    const double rest = 1 - cosine;
    const double squared = rest * rest;
    return squared * squared * rest;
}

/// f0 + (1 - f0)(1 - cosine)^5. Within 0.12 of the exact reflectance of indices from 1.2 to 2.2,
/// worst towards grazing; no total reflection, and not the dip of metals before grazing.
inline double schlickReflectance(double cosine, double f0) {
    return f0 + (1 - f0) * schlickWeight(cosine);
}

}  // namespace hshfit::brdfs
