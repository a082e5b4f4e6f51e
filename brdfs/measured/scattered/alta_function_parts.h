#pragma once

#include <brdfs/measured/scattered/alta_coordinates.h>
#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::brdfs {

/// One function that ALTA fits: a value for each channel. Both directions are above the horizon.
class AltaPart {
public:
    virtual ~AltaPart() = default;
    virtual void eval(const Direction& wi, const Direction& wo, double* values) const = 0;
    /// The coordinates of which it is a function; null: the half vector's angles.
    virtual const AltaCoordinates* coordinates() const { return nullptr; }
    /// Whether the pair lies where the function was fitted.
    virtual bool covers(const Direction&, const Direction&) const { return true; }
    /// A lobe about the mirror direction of this width (Lobe::width); 0: none.
    virtual double mirrorWidth() const { return 0; }
};

/// kd.
std::unique_ptr<AltaPart> altaDiffuse(std::vector<double> kd);
/// ks x^n, x = COS_TH.
std::unique_ptr<AltaPart> altaBlinn(std::vector<double> ks, std::vector<double> n);
/// a / (1 + b (1 - x))^c, of a cosine x, and 0 where x is negative.
std::unique_ptr<AltaPart> altaAbc(const AltaCoordinates& input, std::vector<double> a,
                                  std::vector<double> b, std::vector<double> c);
/// ks exp(n (x - 1)), of a cosine x.
std::unique_ptr<AltaPart> altaGaussian(const AltaCoordinates& input, std::vector<double> ks,
                                       std::vector<double> n);
/// Schlick's R + (1 - R)(1 - <h, wo>)^5.
std::unique_ptr<AltaPart> altaSchlick(std::vector<double> r);

/// The product of powers, or of Legendre polynomials, of these degrees, times a coefficient.
struct AltaTerm {
    std::vector<int> degrees;
    double coefficient = 0;
};

/// A quotient of polynomials of one channel.
struct AltaQuotient {
    std::vector<AltaTerm> numerator, denominator;
};

/// Quotients of u = 2 (x - min)/(max - min) - 1, the coordinates x. Where a denominator is 0 the
/// value is the largest double, with the sign of the numerator; 0/0 and a quotient of two overflows
/// are 0. It covers min <= x <= max.
std::unique_ptr<AltaPart> altaRational(const AltaCoordinates& input, std::vector<double> min,
                                       std::vector<double> max, bool legendre,
                                       std::vector<AltaQuotient> channels);

}  // namespace hshfit::brdfs
