// Models of scatter from polished surfaces and of land surfaces and powders: the formulas as
// printed, in angles, and what they are known to integrate to.

#include "models_angles.h"

#include <hshfit/projection/albedo.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hshfit::brdfs {
namespace {

using std::cos, std::sin, std::tan, std::pow, std::sqrt, std::acos, std::exp, std::log;

/// |beta - beta_0| from polar angles: the chord between wi and the mirror direction of wo,
/// projected.
double deviation(const Angles& a) {
    const double si = sin(a.thetaI), so = sin(a.thetaO);
    return sqrt(std::max(0., si * si + so * so + 2 * si * so * cos(a.phiI - a.phiO)));
}

double cosPhase(const Angles& a) {
    return cos(a.thetaI) * cos(a.thetaO) + sin(a.thetaI) * sin(a.thetaO) * cos(a.phiI - a.phiO);
}

TEST(Formulas, Abg) {
    for (const double b : {1e-3, .2})
        for (const double g : {1., 2., 2.7})
            expectFormula(fmt::format("abg:A=.02,B={},g={},kd=.1", b, g), [&](const Angles& a) {
                return .1 / pi + .02 / (b + pow(deviation(a), g));
            });
    EXPECT_NEAR(evaluate(*open("abg:A=.02,B=.5,g=1.5"), {.6, 0, .8}, {-.6, 0, .8})[0], .04, 1e-12);
}

/// The total integrated scatter at normal incidence is 2 pi A times the integral of x / (B + x^g)
/// over 0 < x < 1: pi A ln(1 + 1/B) for g = 2, and 2 pi A (1 - B ln(1 + 1/B)) for g = 1.
TEST(Formulas, AbgScattersWhatIsKnownInClosedForm) {
    for (const double b : {1e-2, .3, 2.}) {
        const double logarithm = log(1 + 1 / b);
        const auto tis = [&](double g) {
            const auto brdf = open(fmt::format("abg:A=.05,B={},g={}", b, g));
            return directionalAlbedo(*brdf, {0, 0, 1}, 1e-6)[0];
        };
        EXPECT_NEAR(tis(2), pi * .05 * logarithm, 1e-5 * pi * .05 * logarithm) << b;
        const double first = 2 * pi * .05 * (1 - b * logarithm);
        EXPECT_NEAR(tis(1), first, 1e-5 * first) << b;
    }
}

TEST(Formulas, HarveyShack) {
    for (const double s : {-4., -1.5, 0.})
        for (const double l : {.01, .3}) {
            const auto classic = [&](const Angles& a) {
                return 3 * pow(1 + square(deviation(a) / l), s / 2);
            };
            expectFormula(fmt::format("harvey-shack:b0=3,l={},s={},variant=classic", l, s),
                          classic);
            expectFormula(fmt::format("harvey-shack:b0=3,l={},s={}", l, s), [&](const Angles& a) {
                return square((cos(a.thetaI) + cos(a.thetaO)) / 2) * classic(a);
            });
        }
}

/// The classic lobe with s = -2 is ABg with g = 2, A = b0 l^2 and B = l^2.
TEST(Formulas, HarveyShackOfSlopeTwoIsAbg) {
    const auto a = open("harvey-shack:b0=7,l=.2,s=-2,variant=classic"),
               b = open("abg:A=.28,B=.04,g=2");
    for (const Pair& pair : ordinaryPairs(5)) {
        const double f = evaluate(*b, pair.wi, pair.wo)[0];
        EXPECT_NEAR(evaluate(*a, pair.wi, pair.wo)[0], f, 1e-12 * f);
    }
}

/// A surface with a K-correlation spectrum A / (1 + (B x)^2)^(C/2) has the mean square height
/// sigma^2 = 2 pi A / ((C - 2) B^2), and scatters (4 pi sigma / lambda)^2 of the light at normal
/// incidence (Davies 1954) while the lobe is narrow.
TEST(Formulas, HarveyShackScattersTheHeightsOfTheSurface) {
    const double wavelength = .6328, correlation = 200, exponent = 4, sigma = 1e-3;
    const double height = sigma * sigma * (exponent - 2) * correlation * correlation / (2 * pi);
    const double b0 = 16 * pi * pi * height / pow(wavelength, 4);
    const auto brdf =
        open(fmt::format("harvey-shack:b0={},l={},s={}", b0, wavelength / correlation, -exponent));
    const double expected = square(4 * pi * sigma / wavelength);
    EXPECT_NEAR(directionalAlbedo(*brdf, {0, 0, 1}, 1e-6)[0], expected, 1e-4 * expected);
}

/// At equal polar angles, Rayleigh and Rice: (16 pi^2 / lambda^4) cos_i cos_o Q S.
TEST(Formulas, HarveyShackIsRayleighRiceAtEqualPolarAngles) {
    const auto brdf = open("harvey-shack:b0=5,l=.1,s=-3");
    for (const double theta : {.2, .9, 1.4})
        for (const double phi : {.1, 1.5, 3.}) {
            const Direction wi = directionFromAngles(theta, 0),
                            wo = directionFromAngles(theta, phi);
            const double d = 2 * sin(theta) * cos(phi / 2);
            const double expected = 5 * square(cos(theta)) * pow(1 + square(d / .1), -1.5);
            EXPECT_NEAR(evaluate(*brdf, wi, wo)[0], expected, 1e-12 * expected);
        }
}

double rossThick(const Angles& a) {
    const double c = cosPhase(a), xi = acos(std::clamp(c, -1., 1.));
    return ((pi / 2 - xi) * c + sin(xi)) / (cos(a.thetaI) + cos(a.thetaO)) - pi / 4;
}

double liSparse(const Angles& a, double hb, double br) {
    const double ti = std::atan(br * tan(a.thetaI)), to = std::atan(br * tan(a.thetaO));
    const double phi = a.phiI - a.phiO;
    const double c = cos(ti) * cos(to) + sin(ti) * sin(to) * cos(phi);
    const double d = square(tan(ti)) + square(tan(to)) - 2 * tan(ti) * tan(to) * cos(phi);
    const double secants = 1 / cos(ti) + 1 / cos(to);
    const double t = acos(
        std::min(1., hb * sqrt(std::max(0., d) + square(tan(ti) * tan(to) * sin(phi))) / secants));
    return (t - sin(t) * cos(t)) * secants / pi - secants + (1 + c) / 2 / cos(ti) / cos(to);
}

TEST(Formulas, RossLi) {
    expectFormula("ross-li:iso=.3", [](const Angles&) { return .3 / pi; });
    for (const double br : {1., 2.5})
        expectFormula(fmt::format("ross-li:iso=2000,vol=3,geo=.5,br={}", br), [&](const Angles& a) {
            return (2000 + 3 * rossThick(a) + .5 * liSparse(a, 2, br)) / pi;
        });
    expectFormula("ross-li:iso=.1,geo=.05,hb=1.5", [](const Angles& a) {
        return std::max(0., .1 + .05 * liSparse(a, 1.5, 1)) / pi;
    });
}

/// The integrals of both kernels over both hemispheres (white-sky albedo), Lucht et al. 2000, Table
/// 1: 0.189184 and -1.377622. A constant keeps f above 0.
TEST(Formulas, RossLiIntegratesToThePublishedAlbedos) {
    const double constant = 1e5;
    const auto whiteSky = [&](const char* weights) {
        const auto brdf = open(fmt::format("ross-li:iso={},{}", constant, weights));
        double sum = 0;
        const int heights = 160, azimuths = 160;
        for (int i = 0; i < heights; ++i)
            for (int j = 0; j < heights; ++j)
                for (int k = 0; k < azimuths; ++k) {
                    const double ti = (i + .5) / heights * pi / 2, to = (j + .5) / heights * pi / 2;
                    const double f = evaluate(*brdf, directionFromAngles(ti, 0),
                                              directionFromAngles(to, (k + .5) / azimuths * pi))[0];
                    sum += (pi * f - constant) * sin(2 * ti) * sin(2 * to);
                }
        return sum * square(pi / 2 / heights) / azimuths;
    };
    EXPECT_NEAR(whiteSky("vol=1"), 0.189184, 3e-4);
    EXPECT_NEAR(whiteSky("geo=1"), -1.377622, 1e-3);
}

/// Chandrasekhar's H for isotropic scattering, by iteration of 1/H = sqrt(1 - w) +
/// (w/2) integral of x' H(x') / (x + x').
class ExactH {
public:
    explicit ExactH(double w) : w_(w), values_(nodes, 1.) {
        for (int step = 0; step < 400; ++step) {
            std::vector<double> next(nodes);
            // The geometric mean with the last step converges for w = 1 too.
            for (int k = 0; k < nodes; ++k) next[k] = sqrt(values_[k] * at((k + .5) / nodes));
            values_ = next;
        }
    }
    double at(double x) const {
        double sum = 0;
        for (int k = 0; k < nodes; ++k) {
            const double y = (k + .5) / nodes;
            sum += y * values_[k] / (x + y);
        }
        return 1 / (sqrt(1 - w_) + w_ / 2 * sum / nodes);
    }

private:
    static constexpr int nodes = 400;
    double w_;
    std::vector<double> values_;
};

double hapkeH(double x, double w, bool old) {
    const double gamma = sqrt(1 - w), r0 = (1 - gamma) / (1 + gamma);
    if (old) return (1 + 2 * x) / (1 + 2 * gamma * x);
    return 1 / (1 - w * x * (r0 + (1 - 2 * r0 * x) / 2 * log((1 + x) / x)));
}

TEST(Formulas, Hapke) {
    for (const bool old : {true, false})
        for (const double w : {.2, .9}) {
            const double b = .4, c = .3, surge = .8, h = .05;
            const auto henyey = [](double cosine, double x) {
                return (1 - x * x) / pow(1 - 2 * x * cosine + x * x, 1.5);
            };
            expectFormula(fmt::format("hapke:w={},b={},c={},B0={},h={},h-function={}", w, b, c,
                                      surge, h, old ? "1981" : "2002"),
                          [&](const Angles& a) {
                              const double g = acos(std::clamp(cosPhase(a), -1., 1.));
                              const double p = (1 + c) / 2 * henyey(cos(g), b) +
                                               (1 - c) / 2 * henyey(cos(g), -b);
                              const double peak = surge / (1 + tan(g / 2) / h);
                              const double i = cos(a.thetaI), o = cos(a.thetaO);
                              return w / (4 * pi) / (i + o) *
                                     ((1 + peak) * p + hapkeH(i, w, old) * hapkeH(o, w, old) - 1);
                          });
        }
}

/// Isotropic scattering: the reflectance is 1 - sqrt(1 - w) H(cos_i) with Chandrasekhar's H, which
/// both approximations follow to the 4 % and 1 % that their author states.
TEST(Formulas, HapkeReflectsWhatChandrasekharsFunctionSays) {
    EXPECT_NEAR(ExactH(1).at(1), 2.9078, 2e-3);  // his table for w = 1
    for (const double w : {.3, .8, .99}) {
        const ExactH exact(w);
        for (const double x : {1., .5, .1}) {
            EXPECT_NEAR(hapkeH(x, w, true), exact.at(x), .04 * exact.at(x)) << w << " " << x;
            EXPECT_NEAR(hapkeH(x, w, false), exact.at(x), .01 * exact.at(x)) << w << " " << x;
            const Direction wo{sqrt(1 - x * x), 0, x};
            const double expected = 1 - sqrt(1 - w) * exact.at(x);
            const auto reflected = [&](const char* choice) {
                return directionalAlbedo(*open(fmt::format("hapke:w={},{}", w, choice)), wo)[0];
            };
            EXPECT_NEAR(reflected("h-function=1981"), expected, .06 * expected) << w << " " << x;
            EXPECT_NEAR(reflected("h-function=2002"), expected, .02 * expected) << w << " " << x;
        }
    }
}

double rpv(const Angles& a, double rho0, double k, double theta, double rhoc) {
    const double i = cos(a.thetaI), o = cos(a.thetaO), c = cosPhase(a);
    const double m = pow(i, k - 1) * pow(o, k - 1) / pow(i + o, 1 - k);
    const double f =
        (1 - theta * theta) / pow(1 + theta * theta - 2 * theta * cos(pi - acos(c)), 1.5);
    const double gap = square(tan(a.thetaI)) + square(tan(a.thetaO)) -
                       2 * tan(a.thetaI) * tan(a.thetaO) * cos(a.phiI - a.phiO);
    return rho0 * m * f * (1 + (1 - rhoc) / (1 + sqrt(std::max(0., gap)))) / pi;
}

TEST(Formulas, Rpv) {
    for (const double k : {.6, 1., 1.4})
        for (const double theta : {-.3, 0., .25}) {
            expectFormula(fmt::format("rpv:rho0=.2,k={},Theta={}", k, theta),
                          [&](const Angles& a) { return rpv(a, .2, k, theta, .2); });
            expectFormula(fmt::format("rpv:rho0=.2,k={},Theta={},rhoc=.7", k, theta),
                          [&](const Angles& a) { return rpv(a, .2, k, theta, .7); });
        }
    expectFormula("rpv:rho0=.2,k=1,rhoc=1", [](const Angles&) { return .2 / pi; });
}

/// Without bowl and hot spot the phase function's mean over all directions is 1, so that f is, over
/// the whole sphere of wi, rho0 / pi on average.
TEST(Formulas, RpvsPhaseFunctionIsOneOnAverage) {
    const auto brdf = open("rpv:rho0=1,k=1,Theta=-.4,rhoc=1");
    double sum = 0;
    const int heights = 400, azimuths = 64;
    // About wo at the horizon both hemispheres of wi have the same phase angles.
    const Direction wo{sqrt(1 - 1e-12), 0, 1e-6};
    for (int i = 0; i < heights; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const double z = (i + .5) / heights, s = sqrt(1 - z * z);
            const double phi = 2 * pi * (j + .5) / azimuths;
            sum += evaluate(*brdf, {s * cos(phi), s * sin(phi), z}, wo)[0];
        }
    EXPECT_NEAR(pi * sum / heights / azimuths, 1, 1e-4);
}

}  // namespace
}  // namespace hshfit::brdfs
