#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace hshfit::inline transfer {

// Convolution on the sphere with a kernel h that depends on the angle alone,
//     (h * f)(n) = integral of h(angle between n and w) f(w) d omega,
// multiplies band l of the spherical harmonics of f by the kernel's multiplier (Funk 1916, Hecke
// 1918; Schönefeld 2005, Eq. 35)
//     lambda_l = 2 pi integral from -1 to 1 of h(arccos t) P_l(t) dt = sqrt(4 pi / (2l + 1))
//     h_{l,0}
// with h_{l,0} the kernel's zonal coefficient. Only m = 0 of the kernel is used, so that the
// Condon-Shortley phase of f does not matter. Bases of the hemisphere have no such theorem.

/// One row of the table of kernels. Multipliers are for `order` bands, l = 0 .. order - 1, relative
/// error below 1e-12 to order 1000 where they are normal numbers; smaller ones are 0.
struct Kernel {
    std::string_view name;
    std::string_view help;       ///< one line, with the formula
    std::string_view parameter;  ///< its name and domain; empty if there is none
    double least, most;          ///< the parameter's domain
    bool density;                ///< lambda_0 = 1: the kernel integrates to 1
    std::vector<double> (*multipliers)(int order, double parameter);
};

/// clamped-cosine, phong, heat and von-mises-fisher.
std::span<const Kernel> kernelCatalog();
/// Throws UsageError for an unknown name, a parameter outside its domain, or an order below 1.
std::vector<double> kernelMultipliers(std::string_view name, int order, double parameter = 0);

/// max(0, cos): pi, 2 pi / 3, then 0 for odd l and, for even l (Ramamoorthi & Hanrahan 2001),
///     2 pi (-1)^{l/2 - 1} / ((l + 2)(l - 1)) l! / (2^l (l/2)!^2).
std::vector<double> clampedCosine(int order);
/// max(0, cos)^s for 0 <= s <= 1e9, unnormalised: with I_l = integral over [0, 1] of t^s P_l(t) dt,
///     I_0 = 1/(s + 1),  I_1 = 1/(s + 2),  I_l = I_{l-2} (s - l + 2)/(s + l + 1),
/// a product without cancellation, and lambda_l = 2 pi I_l.
std::vector<double> phongLobe(int order, double exponent);
/// The heat kernel, the Gaussian of the sphere, of standard deviation sigma in radians along each
/// tangent axis where it is narrow: exp(-l (l + 1) sigma^2 / 2). Two such kernels convolve to one.
std::vector<double> heatKernel(int order, double sigma);
/// The von Mises-Fisher density kappa exp(kappa cos) / (4 pi sinh kappa), 0 <= kappa <= 1e12, near
/// the heat kernel of sigma^2 = 1/kappa: I_{l+1/2}(kappa) / I_{1/2}(kappa), by the recurrence
/// r_{l-1} = r_{l+1} + (2l + 1)/kappa r_l downwards, all of whose terms are positive.
std::vector<double> vonMisesFisher(int order, double kappa);

/// A kernel by its values: out[k] = h(angles[k]), angles in radians from 0 to pi.
using AngleFunction = std::function<void(std::span<const double> angles, double* out)>;

struct AngleOptions {
    /// Angles at which h or a derivative jumps; panels of the quadrature end there.
    std::vector<double> breaks = {};
    double last = 3.14159265358979323846;  ///< h is 0 beyond this angle
    /// Share of the integral of |h|: panels are halved until h is resolved to it.
    double tolerance = 1e-13;
};
/// The multipliers of any kernel, by Gauss-Legendre panels in the angle that are halved until h
/// is a polynomial on each, and are short against the period of P_{order-1}. Absolute error about
/// the tolerance times lambda_0 of |h|. Throws NumericError for a value that is no finite number,
/// and where h is not resolved by 100,000 panels.
std::vector<double> multipliersOf(const AngleFunction& h, int order,
                                  const AngleOptions& options = {});

/// coefficients[l(l+1) + m] *= multipliers[l]; throws UsageError if there are fewer multipliers
/// than bands or if the coefficients are not order^2 numbers.
void convolve(std::span<double> coefficients, std::span<const double> multipliers);

/// h_{l,0} = lambda_l sqrt((2l + 1) / (4 pi)).
std::vector<double> zonalCoefficients(std::span<const double> multipliers);

}  // namespace hshfit::inline transfer
