#pragma once

#include <array>

namespace hshfit::brdfs {

/// The reflectance in R, G and B (linear Rec. 709) of a base under a film, by Airy's sum with its
/// spectral integrals in Fourier space: Belcour & Barla 2017, 10.1145/3072959.3073620, with what
/// KHR_materials_iridescence leaves out (its section "Iridescence Fresnel"). Light of the polar
/// cosine `cosine` comes from air; the film has the index `ior` >= 1 and its thickness in
/// nanometres, the base the reflectance `f0` at normal incidence from air.
///     R12 = Schlick's form of ((ior - 1)/(ior + 1))^2 at c, R23 of ((n - ior)/(n + ior))^2 at c2,
///     n = (1 + root f0)/(1 - root f0), c2^2 = 1 - (1 - c^2)/ior^2,  T = 1 - R12,
///     Rs = T^2 R23/(1 - R12 R23),
///     R = R12 + Rs + 2 (Rs - T) sum_m (s root(R12 R23))^m S(m 2 ior thickness c2), m = 1, 2,
/// cut to [0, 1]; s = -1 if n >= ior, else 1. S(D), the Fourier transform of Gaussians fitted to
/// the CIE curves, is sum_j a_j cos(2 pi p_j D) exp(-v_j (2 pi D)^2) in X, Y and Z, in R, G and B
/// by Rec. 709's matrix, with the constants of the extension. f0 is at most 0.9999 and R12 R23 at
/// least 1e-5; below 0.03 nm the film's index goes to 1 (three.js, Babylon.js, the Khronos
/// viewer).
///
/// The extension's listing gives the curves X, Y and Z the signs s of R, G and B; here a channel
/// has its own s in all three, which differs where ior lies between the n of two channels. The
/// cut at 1 is of this program too. Accuracy: tests/brdfs/thin_film_test.cpp.
std::array<double, 3> thinFilmReflectance(double cosine, double ior, double nanometres,
                                          const std::array<double, 3>& f0);

/// The base of a film in each channel.
template <class N>
struct FilmBase {
    std::array<N, 3> reflectance;  ///< at normal incidence from the film
    std::array<double, 3> sign;    ///< s
};

/// The film of a standard material: numbers that depend on its parameters alone.
template <class N>
struct FilmShape {
    N weight;  ///< share of the facets that have it
    N ior;     ///< of the film
    N path;    ///< 2 pi times 2 ior thickness, metres
    N top;     ///< reflectance of its upper boundary at normal incidence
    FilmBase<N> dielectric, metal;
    std::array<N, 3> dielectricScale, metalScale;  ///< of the reflectances under the film
};

}  // namespace hshfit::brdfs
