// Captured energies against computations that share nothing with the projector: other quadrature
// nodes, other coordinates, other basis code, formulas written out again.

#include <hshfit/bases/catalog.h>
#include <hshfit/projection/projection.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <gsl/gsl_integration.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace hshfit {
namespace {

/// GSL's rule on [a, b]; 512 and 1024 points are among the sizes it tabulates exactly.
struct Rule {
    std::vector<double> x, w;
    Rule(std::size_t n, double a, double b) : x(n), w(n) {
        gsl_integration_glfixed_table* table = gsl_integration_glfixed_table_alloc(n);
        for (std::size_t i = 0; i < n; ++i) {
            gsl_integration_glfixed_point(a, b, i, &x[i], &w[i], table);
        }
        gsl_integration_glfixed_table_free(table);
    }
};

double factorialRatio(int a, int b) {  // a! / b!
    return std::exp(std::lgamma(a + 1.0) - std::lgamma(b + 1.0));
}

/// Theta parts from their textbook definitions; std::assoc_legendre carries no phase.
double thetaPart(const std::string& basis, int l, int m, double mu) {
    if (basis == "hsh") {
        return std::sqrt((2 * l + 1) * factorialRatio(l - m, l + m)) *
               std::assoc_legendre(l, m, 2 * mu - 1);
    }
    if (basis == "zernike") {
        if ((l - m) % 2) return 0;
        const double rho = std::sqrt(1 - mu);
        double radial = 0;
        for (int k = 0; k <= (l - m) / 2; ++k) {
            radial += (k % 2 ? -1 : 1) * factorialRatio(l - k, k) /
                      (std::tgamma((l + m) / 2 - k + 1) * std::tgamma((l - m) / 2 - k + 1)) *
                      std::pow(rho, l - 2 * k);
        }
        return std::sqrt(l + 1) * radial;
    }
    const double y =
        std::sqrt((l + 0.5) * factorialRatio(l - m, l + m)) * std::assoc_legendre(l, m, mu);
    if (basis == "esh") return (l + m) % 2 ? 0 : std::sqrt(2.0) * y;
    return y;
}

using Function = std::function<double(const Direction&)>;

/// Accumulates the coefficients and the energy of samples that carry their own weights.
struct Accumulator {
    std::string basis;
    int order;
    std::vector<double> coefficients = std::vector<double>(order * order, 0.0);
    double energy = 0;

    void add(const Direction& wi, double value, double weight) {
        energy += weight * value * value;
        if (value == 0) return;
        const double phi = std::atan2(wi.y, wi.x);
        for (int m = 0; m < order; ++m) {
            for (int l = m; l < order; ++l) {
                const double t = weight * value * thetaPart(basis, l, m, wi.z);
                if (m == 0) {
                    coefficients[slotOf(l, 0)] += t / std::sqrt(2 * pi);
                    continue;
                }
                coefficients[slotOf(l, m)] += t * std::cos(m * phi) / std::sqrt(pi);
                coefficients[slotOf(l, -m)] += t * std::sin(m * phi) / std::sqrt(pi);
            }
        }
    }
    double accuracy() const {
        double sum = 0;
        for (double c : coefficients) sum += c * c;
        return sum / energy;
    }
};

/// Phong in coordinates about the lobe's axis, (alpha, psi), cut at the horizon: nodes end exactly
/// where f does, and crowd there quadratically for functions like sqrt(cos theta).
double phongAccuracy(const std::string& basis, int order, double exponent, double tilt) {
    Accumulator sum{basis, order};
    const Direction axis = directionFromAngles(tilt, pi);
    const Direction e1{axis.z, 0, -axis.x}, e2{0, 1, 0};  // e1 points down from the axis for x < 0
    const double reach = std::min(pi / 2, 14 / std::sqrt(exponent));
    const Rule half(100, 0, 1);
    for (int part = 0; part < 2; ++part) {
        for (std::size_t i = 0; i < half.x.size(); ++i) {
            const double psi = (part + half.x[i]) * pi / 2, psiWeight = half.w[i] * pi / 2;
            const double down = -(e1.z * std::cos(psi));  // horizon where tan(alpha) down = axis.z
            const double edge = down > 0 ? std::atan(axis.z / down) : pi / 2;
            const double limit = std::min(edge, reach);
            for (std::size_t j = 0; j < half.x.size(); ++j) {
                const double t = half.x[j], alpha = limit * t * (2 - t);
                const double weight = psiWeight * half.w[j] * limit * 2 * (1 - t) * std::sin(alpha);
                for (double side : {1.0, -1.0}) {
                    const double a = std::cos(alpha), b = std::sin(alpha) * std::cos(psi),
                                 c = side * std::sin(alpha) * std::sin(psi);
                    const Direction wi{a * axis.x + b * e1.x + c * e2.x, c,
                                       std::max(a * axis.z + b * e1.z, 0.0)};
                    sum.add(wi, std::pow(a, exponent), weight);
                }
            }
        }
    }
    return sum.accuracy();
}

/// Any smooth q on a dense grid: Gauss-Legendre in t with theta = pi/2 (1 - (1-t)^2), midpoints in
/// azimuth.
double gridAccuracy(const std::string& basis, int order, const Function& q, std::size_t rings,
                    std::size_t azimuths) {
    Accumulator sum{basis, order};
    const Rule rule(rings, 0, 1);
    for (std::size_t i = 0; i < rings; ++i) {
        const double t = rule.x[i], theta = pi / 2 * (1 - (1 - t) * (1 - t));
        const double weight = rule.w[i] * pi * (1 - t) * std::sin(theta);
        for (std::size_t j = 0; j < azimuths; ++j) {
            const double step = 2 * pi / static_cast<double>(azimuths);
            const Direction wi = directionFromAngles(theta, (static_cast<double>(j) + 0.5) * step);
            sum.add(wi, q(wi), weight * step);
        }
    }
    return sum.accuracy();
}

double projected(const std::string& spec, const std::string& basis, int order,
                 const OutgoingSet& outgoing, Quantity quantity) {
    const auto brdf = brdfs::open(spec);
    const auto made = bases::make(basis, order);
    const Basis* const one[] = {made.get()};
    const auto result = project(*brdf, one, outgoing, {.quantity = quantity});
    return result[0].captured.back() / result[0].coefficients.energy.value;
}

class PhongAccuracy : public testing::TestWithParam<std::tuple<std::string, double, double>> {};

TEST_P(PhongAccuracy, AgreesWithLobeCoordinates) {
    const auto [basis, exponent, tilt] = GetParam();
    const auto wo = OutgoingSet::direction(radians(tilt), 0);
    EXPECT_NEAR(projected(fmt::format("phong:exponent={}", exponent), basis, 6, wo, Quantity::brdf),
                phongAccuracy(basis, 6, exponent, radians(tilt)), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Tilted, PhongAccuracy,
                         testing::Combine(testing::Values("hsh", "sh", "esh", "zernike"),
                                          testing::Values(1.0, 5.0, 37.0, 1000.0),
                                          testing::Values(0.0, 45.0, 80.0)));

/// Ward 1992 from the paper: exp(-tan^2(delta)(...))/(4 pi ax ay sqrt(cos cos)), in half vectors.
double wardCosine(const Direction& wi, const Direction& wo, double ax, double ay) {
    const double hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
    const double slopes = (hx * hx / (ax * ax) + hy * hy / (ay * ay)) / (hz * hz);
    return std::sqrt(wi.z / wo.z) * std::exp(-slopes) / (4 * pi * ax * ay);
}

/// GGX with height-correlated Smith masking (Heitz 2014) and F0 = 1, so that F = 1.
double ggxCosine(const Direction& wi, const Direction& wo, double alpha) {
    const double hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
    const double cos2 = hz * hz / (hx * hx + hy * hy + hz * hz), a2 = alpha * alpha;
    const double d = a2 / (pi * std::pow(cos2 * (a2 - 1) + 1, 2));
    const auto lambda = [&](double z) {
        return (std::sqrt(1 + a2 * (1 - z * z) / (z * z)) - 1) / 2;
    };
    return d / (1 + lambda(wi.z) + lambda(wo.z)) / (4 * wo.z);
}

TEST(ProjectionAccuracy, WardTimesCosineOnADenseGrid) {
    for (const auto& [theta, phi] : {std::pair(20.0, 0.0), {45.0, 30.0}, {70.0, 90.0}}) {
        const auto set = OutgoingSet::direction(radians(theta), radians(phi));
        const Direction wo = set.directions[0];
        for (const char* basis : {"hsh", "sh", "esh", "zernike"}) {
            EXPECT_NEAR(
                projected("ward:ax=0.2,ay=0.5", basis, 5, set, Quantity::brdfCosine),
                gridAccuracy(
                    basis, 5, [&](const Direction& wi) { return wardCosine(wi, wo, 0.2, 0.5); },
                    128, 256),
                1e-6)
                << basis << " at " << theta;
        }
    }
}

TEST(ProjectionAccuracy, GgxTimesCosineOnADenseGrid) {
    for (const double theta : {0.0, 40.0, 70.0}) {
        const auto set = OutgoingSet::direction(radians(theta), 0);
        const Direction wo = set.directions[0];
        for (const char* basis : {"hsh", "esh"}) {
            EXPECT_NEAR(projected("ggx:alpha=0.3,F0=1", basis, 5, set, Quantity::brdfCosine),
                        gridAccuracy(
                            basis, 5, [&](const Direction& wi) { return ggxCosine(wi, wo, 0.3); },
                            256, 512),
                        1e-6)
                << basis << " at " << theta;
        }
    }
}

/// Symmetry only leaves work out: each direction of a map has the coefficients that it has alone.
TEST(ProjectionSymmetry, MapsAgreeWithSingleDirections) {
    const auto basis = bases::make("hsh", 5);
    const Basis* const one[] = {basis.get()};
    for (const char* spec : {"ggx:alpha=0.4,F0=0.9", "ward:ax=0.3,ay=0.6", "phong:exponent=9",
                             "ashikhmin-shirley:nu=20,nv=60"}) {
        const auto brdf = brdfs::open(spec);
        const auto options = ProjectionOptions{.quantity = Quantity::brdfCosine};
        const Projection map = project(*brdf, one, OutgoingSet::parabolic(6, 8), options)[0];
        const auto& directions = map.coefficients.outgoing.directions;
        for (std::size_t k = 0; k < directions.size(); k += 5) {
            const auto alone =
                OutgoingSet::direction(polarAngle(directions[k]), azimuth(directions[k]));
            const Projection single = project(*brdf, one, alone, options)[0];
            double norm = 0, difference = 0;
            for (std::size_t i = 0; i < map.coefficients.slots(); ++i) {
                const double c = single.coefficients.at(0, 0)[i];
                norm += c * c;
                difference += std::pow(c - map.coefficients.at(k, 0)[i], 2);
            }
            EXPECT_LE(std::sqrt(difference), 2e-6 * std::sqrt(norm)) << spec << " " << k;
        }
    }
}

}  // namespace
}  // namespace hshfit
