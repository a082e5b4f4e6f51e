#pragma once

#include <brdfs/catalog/tables.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A law over the wavelength of one parameter of a fit.
///     free         a value at each wavelength
///     shared       one value
///     cauchy:N     A + B / lambda^2 + C / lambda^4 ..., N terms, lambda in micrometres
///     sellmeier:N  n^2 = 1 + sum_i B_i lambda^2 / (lambda^2 - C_i), N terms; poles of the first
///     two
///                  lie below 0.9 of the band, of the third above 1.1 of it, and n^2 > 1 in it
///     poly:N       a polynomial of degree N in lambda
///     spline:N     a cubic spline with N coefficients and equal distances between knots
struct DispersionLaw {
    enum class Kind { free, shared, cauchy, sellmeier, poly, spline };
    Kind kind = Kind::free;
    std::string_view name, help;
    int least = 0, most = 0, fallback = 0;  ///< of N; `most` 0: takes none
    bool ofIndex = false;                   ///< only of an index of refraction (ior, and k)
};
std::span<const DispersionLaw> dispersionLaws();

/// "PARAMETER=LAW[:N]".
struct LawStatement {
    std::string parameter;
    DispersionLaw::Kind kind = DispersionLaw::Kind::free;
    int order = 0;
    std::string text() const;  ///< "spline:6"
};
/// "ior=cauchy:2,kd=spline:6". Throws UsageError with the known laws.
std::vector<LawStatement> parseDispersion(std::string_view text);

/// A law between the ends of a band, for a parameter within bounds. Its coefficients lie in a box,
/// anywhere in which the curve keeps the bounds of the parameter all over the band: Bernstein's
/// coefficients in lambda or, of cauchy, in 1 / lambda^2; B-spline coefficients; of sellmeier the
/// share of each term in n^2 - 1 and its pole.
class LawCurve {
public:
    /// `wavelengths`: of the data, ascending, nm. Throws UsageError for fewer of them than
    /// coefficients.
    LawCurve(const LawStatement& law, double least, double most,
             std::span<const double> wavelengths);

    std::size_t count() const { return lower_.size(); }
    const std::vector<double>& lower() const { return lower_; }
    const std::vector<double>& upper() const { return upper_; }
    /// The value at a wavelength, and its derivatives by the coefficients: [count()].
    double at(double nanometres, std::span<const double> coefficients, double* slopes) const;
    /// Whether the law holds between the wavelengths of the data too.
    bool interpolates() const { return kind_ != DispersionLaw::Kind::free; }
    /// Coefficients whose curve comes nearest to values at the wavelengths of the data.
    std::vector<double> nearest(std::span<const double> values) const;

    /// The parameters that a report states: A, B and C of cauchy, B1 and C1 … of sellmeier, the
    /// coefficients themselves of the others. `slopes[i * count() + j]`: by coefficient j.
    struct Reported {
        std::vector<std::string> names;  ///< ".A", "@532nm", "" for shared
        std::vector<double> values, slopes;
    };
    Reported reported(std::span<const double> coefficients) const;

private:
    Reported cauchyTerms(std::span<const double> coefficients) const;
    double sellmeierStart(std::size_t i, double index, double share) const;

    DispersionLaw::Kind kind_;
    std::vector<double> wavelengths_;
    std::vector<double> knots_;  ///< of the B-spline, in nm or, of cauchy, in 1 / um^2
    std::size_t degree_ = 0;
    std::vector<double> lower_, upper_;
};

}  // namespace hshfit::brdfs
