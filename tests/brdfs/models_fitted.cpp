// The two models that take more than a formula: the shifted gamma distribution with its
// normalisation, and He's series. Against the papers' equations as printed, limits, and Boost.Math.

#include "models_grid.h"

#include <brdfs/analytic/he.h>
#include <brdfs/analytic/term_brdf.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/special_functions/lambert_w.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace hshfit::brdfs {
namespace {

using std::cos, std::sin, std::tan, std::exp, std::pow, std::sqrt, std::erfc;

double square(double x) {
    return x * x;
}

/// Unit half vector and the angles of both directions.
struct Geometry {
    double thetaI, thetaO, thetaH, cosHO;

    explicit Geometry(const Pair& p) : thetaI(std::acos(p.wi.z)), thetaO(std::acos(p.wo.z)) {
        const double x = p.wi.x + p.wo.x, y = p.wi.y + p.wo.y, z = p.wi.z + p.wo.z;
        thetaH = std::atan2(std::hypot(x, y), z);
        cosHO = (x * p.wo.x + y * p.wo.y + z * p.wo.z) / sqrt(x * x + y * y + z * z);
    }
};

/// Pairs of which neither grazes.
std::vector<Pair> highPairs(unsigned seed) {
    std::vector<Pair> high;
    for (const Pair& pair : ordinaryPairs(seed))
        if (pair.wi.z > .02 && pair.wo.z > .02) high.push_back(pair);
    return high;
}

struct Shape {
    double alpha, p, lambda, c, k, theta0, f0, f1;
};
const Shape shapes[]{{.0148, .459, 2.6, 1e-7, 47, .2, 6.05, 5.05},
                     {.28, .92, 4.3, .056, 9.7, .39, .14, .11},
                     {.5, 0, 0, 0, 1, 0, .04, 0},
                     {.1, 1.7, 1.5, 1.2, 6, -.1, .9, .3}};

std::string specOf(const Shape& s) {
    return fmt::format("sgd:ks=.7,kd=.1,alpha={},p={},Lambda={},c={},k={},theta0={},F0={},F1={}",
                       s.alpha, s.p, s.lambda, s.c, s.k, s.theta0, s.f0, s.f1);
}

TEST(Sgd, AgreesWithThePrintedEquations) {
    for (const Shape& s : shapes) {
        SCOPED_TRACE(specOf(s));
        const auto brdf = open(specOf(s));
        // Gamma(1 - p, alpha) = (Gamma(2 - p, alpha) - alpha^(1 - p) exp(-alpha)) / (1 - p).
        const double gamma =
            (boost::math::tgamma(2 - s.p, s.alpha) - pow(s.alpha, 1 - s.p) * exp(-s.alpha)) /
            (1 - s.p);
        const auto g1 = [&](double theta) {
            if (theta <= s.theta0) return 1.;
            return std::clamp(1 + s.lambda * (1 - exp(s.c * pow(theta - s.theta0, s.k))), 0., 1.);
        };
        for (const Pair& pair : highPairs(41)) {
            const Geometry a(pair);
            const double u = s.alpha + square(tan(a.thetaH)) / s.alpha;
            const double d = exp(-u) / (s.alpha * gamma * pow(u, s.p) * pi * pow(cos(a.thetaH), 4));
            const double f = s.f0 - a.cosHO * s.f1 + (1 - s.f0) * pow(1 - a.cosHO, 5);
            const double expected = .1 / pi + .7 / pi * std::max(0., f) * d * g1(a.thetaI) *
                                                  g1(a.thetaO) / (cos(a.thetaI) * cos(a.thetaO));
            EXPECT_NEAR(evaluate(*brdf, pair.wi, pair.wo)[0] / expected, 1, 2e-8);
        }
    }
}

// K of the published tables: printed to six digits beside alpha and p (alum-bronze, red channel).
TEST(Sgd, NormalisationIsThePublishedOne) {
    const Direction up{0, 0, 1};
    const std::string shape = "sgd:alpha=.014832,p=.459076";
    const double derived = evaluate(*open(shape), up, up)[0];
    EXPECT_NEAR(derived / evaluate(*open(shape + ",K=46.3841"), up, up)[0], 1, 1e-5);
}

using Real = boost::multiprecision::cpp_bin_float_50;

/// The series term by term in 50 digits.
double seriesInFull(double g, double b) {
    Real sum = 0, power = exp(Real(-g));
    const Real variable = g, damping = b;
    const int terms = static_cast<int>(g + 60 * sqrt(g) + 4 * sqrt(b) + 200);
    for (int m = 1; m <= terms; ++m) {
        power *= (m == 1 ? Real(1) : variable) / m;
        sum += power * exp(-damping / m) / m;
    }
    return sum.convert_to<double>();
}

TEST(He, SeriesFromThinToRough) {
    for (const double g : {1e-300, 1e-6, 1e-3, .1, 1., 7., 30., 60., 100., 160., 500., 3e3, 2e4})
        for (const double spread : {0., 1e-6, .01, 1., 9., 60., 400.}) {
            const double b = spread * (1 + g);
            const double full = seriesInFull(g, b);
            if (full < 1e-280) continue;
            EXPECT_NEAR(heSeries(g, b) / full, 1, 1e-12) << g << " " << b;
        }
    EXPECT_EQ(heSeries(0, 0), 1);
    EXPECT_NEAR(heSeries(0, 2), exp(-2), 1e-15);
    // Mean of exp(-b/m) / m over a Poisson distribution of mean g, to the next order in 1 / g.
    for (const double g : {1e6, 1e9, 1e14})
        EXPECT_NEAR(heSeries(g, 0) * g * g, 1 + 1 / g, 3 / g / g + 1e-7 * sqrt(g / 1e14) + 1e-9);
}

TEST(He, LambertWAgreesWithBoost) {
    for (const double x : {0., 1e-300, 1e-9, .01, .5, 1., 3., 9.99, 10.01, 1e3, 1e10, 1e100, 1e300})
        EXPECT_NEAR(lambertW(x), boost::math::lambert_w0(x),
                    1e-15 * (1 + boost::math::lambert_w0(x)));
}

/// Eqs. 23 to 25 and 76 to 84 of He et al. 1991 with lengths in wavelengths, the dot products of
/// Eq. 76 in full and Eq. 81 solved by bisection.
double printed(const Pair& pair, double sigma0, double tau, double ior) {
    const Direction &wi = pair.wi, &wo = pair.wo;
    const Geometry a(pair);
    const auto scaled = [&](double theta) { return tau / tan(theta) / (2 * sigma0); };
    const auto hidden = [&](double theta) { return tan(theta) * erfc(scaled(theta)); };
    const double k = hidden(a.thetaI) + hidden(a.thetaO);
    double low = 0, high = sigma0 * 100;
    for (int i = 0; i < 200; ++i) {
        const double z = (low + high) / 2;
        const bool below = sqrt(pi / 2) * z < sigma0 / 4 * k * exp(-z * z / (2 * sigma0 * sigma0));
        (below ? low : high) = z;
    }
    const double sigma = sigma0 / sqrt(1 + square(low / sigma0));
    const double g = square(2 * pi * sigma * (cos(a.thetaI) + cos(a.thetaO)));
    const double vx = 2 * pi * (wi.x + wo.x), vy = 2 * pi * (wi.y + wo.y);
    const double vz = 2 * pi * (wi.z + wo.z), v2 = vx * vx + vy * vy + vz * vz;
    const double d =
        square(pi * tau) / 4 * g * seriesInFull(g, (vx * vx + vy * vy) * tau * tau / 4);
    const auto s1 = [&](double theta) {
        const double x = scaled(theta);
        const double lambda =
            .5 * (2 / sqrt(pi) * sigma0 / tau * tan(theta) * exp(-x * x) - erfc(x));
        return (1 - .5 * erfc(x)) / (lambda + 1);
    };
    // s = k x n / |k x n| and p = s x k for k_i = -wi, k_r = wo.
    const auto cross = [](const Direction& u, const Direction& v) {
        return Direction{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    };
    const auto unit = [](Direction u) {
        const double length = sqrt(dot(u, u));
        return Direction{u.x / length, u.y / length, u.z / length};
    };
    const Direction ki{-wi.x, -wi.y, -wi.z}, up{0, 0, 1};
    const Direction si = unit(cross(ki, up)), sr = unit(cross(wo, up));
    const Direction pi_ = cross(si, ki), pr = cross(sr, wo), kk = cross(wo, ki);
    const double geometry = square(v2 / square(2 * pi) / (vz / (2 * pi))) / square(dot(kk, kk)) *
                            (square(dot(sr, ki)) + square(dot(pr, ki))) *
                            (square(dot(si, wo)) + square(dot(pi_, wo)));
    const double inside = sqrt(1 - (1 - square(a.cosHO)) / (ior * ior));
    const double rs = (a.cosHO - ior * inside) / (a.cosHO + ior * inside);
    const double rp = (inside - ior * a.cosHO) / (inside + ior * a.cosHO);
    return (rs * rs + rp * rp) / 2 * geometry * s1(a.thetaI) * s1(a.thetaO) * d /
           (pi * cos(a.thetaI) * cos(a.thetaO));
}

TEST(He, AgreesWithThePrintedEquations) {
    struct Surface {
        double sigma, tau, ior;
    };
    for (const Surface s : {Surface{.02, 3, 1.5}, {.18, 3, 2.}, {.3, 1.5, 1.3}, {.8, 5, 1.5}}) {
        const auto brdf = open(fmt::format("he:sigma={},tau={},ior={}", s.sigma, s.tau, s.ior));
        for (const Pair& pair : highPairs(42)) {
            const double expected = printed(pair, s.sigma, s.tau, s.ior);
            EXPECT_NEAR(evaluate(*brdf, pair.wi, pair.wo)[0], expected, 1e-8 * expected + 1e-14)
                << s.sigma;
        }
    }
}

TEST(He, OnlyRatiosToTheWavelengthMatter) {
    const auto one = open("he:sigma=.18,tau=3"), other = open("he:sigma=.09,tau=1.5,wavelength=.5");
    for (const Pair& pair : ordinaryPairs(43))
        EXPECT_DOUBLE_EQ(evaluate(*one, pair.wi, pair.wo)[0],
                         evaluate(*other, pair.wi, pair.wo)[0]);
}

// Geometrical optics: with heights of many wavelengths the series is Beckmann's distribution, the
// effective height the whole one where nothing hides, and S as good as 1.
TEST(He, RoughLimitIsBeckmanns) {
    const double slope = .1;
    const auto he = open(fmt::format("he:sigma=100,tau={},ior=1.5", 200 / slope));
    const auto facets = open(fmt::format("cook-torrance:m={},ior=1.5,norm=4", slope));
    Directions directions(44);
    int compared = 0;
    for (int i = 0; i < 400; ++i) {
        const Direction wo = directions.next(), wi = directions.near(mirrored(wo), .1);
        if (wo.z < .6 || wi.z < .6) continue;  // no shading by V-grooves either
        const double expected = evaluate(*facets, wi, wo)[0];
        EXPECT_NEAR(evaluate(*he, wi, wo)[0] / expected, 1, 2e-4);
        ++compared;
    }
    EXPECT_GT(compared, 50);
}

}  // namespace
}  // namespace hshfit::brdfs
