#include <hshfit/light/internal/hosek_wilkie_sky.h>

#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr double kilolumens = 0.683;  // a watt at the peak of the CIE's luminous efficiency
constexpr double horizonOffset = 0.01;
constexpr double mostRadiance = 1e9;

using Channel = HosekWilkieChannel;

/// The places of the tables about a turbidity, an albedo and the sun's elevation, with weights.
struct TableBlend {
    std::array<double, Channel::albedos> albedo;
    std::size_t turbidity;  ///< index of the lower one
    double above;           ///< weight of the one above it
    std::array<double, Channel::points> bezier;

    TableBlend(double turbid, double ground, const Direction& sun)
        : albedo{1 - ground, ground},
          turbidity(std::min(static_cast<std::size_t>(turbid), Channel::turbidities - 1) - 1),
          above(turbid - static_cast<double>(turbidity + 1)) {
        constexpr double binomial[] = {1, 5, 10, 10, 5, 1};
        const double elevation = std::clamp(pi / 2 - polarAngle(sun), 0.0, pi / 2);
        const double t = std::cbrt(elevation / (pi / 2));
        for (std::size_t k = 0; k < bezier.size(); ++k) {
            const auto power = static_cast<int>(k);
            bezier[k] = binomial[k] * std::pow(1 - t, 5 - power) * std::pow(t, power);
        }
    }

    /// Item `k` of the `stride` items at every control point.
    double of(const std::vector<double>& table, std::size_t stride, std::size_t k) const {
        double sum = 0;
        for (std::size_t a = 0; a < albedo.size(); ++a) {
            for (const std::size_t next : {0U, 1U}) {
                const double weight = albedo[a] * (next == 0 ? 1 - above : above);
                const std::size_t block = a * Channel::turbidities + turbidity + next;
                for (std::size_t p = 0; p < bezier.size(); ++p)
                    sum += weight * bezier[p] * table[(block * Channel::points + p) * stride + k];
            }
        }
        return sum;
    }
};

/// Linear Rec. 709 of 1 in channel `k` alone, in 1000 cd/m^2.
Rgb colourOfChannel(const HosekWilkieTables& tables, std::size_t k) {
    std::array<double, 3> one{};
    if (tables.kind == HosekWilkieTables::Kind::spectral) {
        std::array<double, hosekWilkieWavelengths.size()> spectrum{};
        spectrum[k] = 1;
        one = rec709FromXyz(tristimulusOfRadiance(hosekWilkieWavelengths, spectrum));
    } else {
        one[k] = 1;
        if (tables.kind == HosekWilkieTables::Kind::xyz) one = rec709FromXyz(one);
    }
    for (double& value : one) value *= kilolumens;
    return one;
}

/// A bound of the formula over the whole sky.
double boundOfFormula(const std::array<double, Channel::coefficients>& s) {
    const double gradation = std::max(std::exp(s[1] / horizonOffset), std::exp(s[1]));
    const double nearest = std::pow(1 - std::abs(s[8]), 2);
    return (1 + std::abs(s[0]) * gradation) *
           (std::abs(s[2]) + std::abs(s[3]) * std::max(1.0, std::exp(s[4] * pi)) + std::abs(s[5]) +
            std::abs(s[6]) * 2 / std::pow(nearest, 1.5) + std::abs(s[7]));
}

double hosekWilkieFormula(const std::array<double, Channel::coefficients>& s, double cosTheta,
                          double gamma) {
    const double cosGamma = std::cos(gamma), square = cosGamma * cosGamma;
    const double chi = (1 + square) / std::pow(1 + s[8] * s[8] - 2 * s[8] * cosGamma, 1.5);
    return (1 + s[0] * std::exp(s[1] / (cosTheta + horizonOffset))) *
           (s[2] + s[3] * std::exp(s[4] * gamma) + s[5] * square + s[6] * chi +
            s[7] * std::sqrt(cosTheta));
}

}  // namespace

SkyLight hosekWilkieSky(const HosekWilkieTables& tables, const std::string& file, double turbidity,
                        double albedo, const Direction& sun) {
    assert(turbidity >= 1 && turbidity <= 10 && albedo >= 0 && albedo <= 1 && sun.z >= -1e-12);
    const TableBlend blend(turbidity, albedo, sun);
    std::vector<HosekWilkieTerm> terms;
    double bound = 0;
    for (std::size_t k = 0; k < tables.channels.size(); ++k) {
        const Channel& channel = tables.channels[k];
        HosekWilkieTerm term{.shape = {}, .colour = colourOfChannel(tables, k)};
        for (std::size_t i = 0; i < term.shape.size(); ++i)
            term.shape[i] = blend.of(channel.shape, term.shape.size(), i);
        const double radiance = blend.of(channel.radiance, 1, 0);
        for (double& value : term.colour) {
            value *= radiance;
            bound += std::abs(value) * boundOfFormula(term.shape);
        }
        terms.push_back(term);
    }
    if (!(bound <= mostRadiance))
        throw InputError(
            fmt::format("{}: the tables give no finite sky for turbidity {}, albedo "
                        "{} and the sun at {:.4g} degrees: radiance up to {:.3g}",
                        file, turbidity, albedo, 90 - degrees(polarAngle(sun)), bound));
    SkyLight sky{.model = SkyLight::Model::hosekWilkie, .zenith = {1, 1, 1}, .sun = sun};
    sky.terms = std::make_shared<const std::vector<HosekWilkieTerm>>(std::move(terms));
    return sky;
}

Rgb hosekWilkieColour(std::span<const HosekWilkieTerm> terms, double cosTheta, double gamma) {
    Rgb colour{};
    for (const HosekWilkieTerm& term : terms) {
        const double value = hosekWilkieFormula(term.shape, cosTheta, gamma);
        for (std::size_t c = 0; c < 3; ++c) colour[c] += term.colour[c] * value;
    }
    for (double& value : colour) value = std::max(value, 0.0);
    return colour;
}

}  // namespace hshfit::inline light
