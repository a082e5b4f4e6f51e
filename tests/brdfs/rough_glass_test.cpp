// The model of transmission through rough glass against Walter et al. 2007 in the paper's own
// terms: its formula, its energy together with the energy of reflection, the smooth limit, and
// reciprocity.

#include <brdfs/catalog.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/projection/albedo.h>

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <random>

namespace hshfit {
namespace {

using Vector = std::array<double, 3>;

Vector vectorOf(const Direction& d) {
    return {d.x, d.y, d.z};
}
double dot3(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The reflectance of a dielectric, of the cosine of the incident angle: Walter et al., Eq. 22.
double fresnel(double c, double ratio) {
    const double squared = ratio * ratio - 1 + c * c;
    if (squared < 0) return 1;
    const double g = std::sqrt(squared);
    const double a = (g - c) / (g + c), b = (c * (g + c) - 1) / (c * (g - c) + 1);
    return 0.5 * a * a * (1 + b * b);
}

/// D and G_1 of the paper, Eq. 33, 34 and 25, Beckmann's G_1 by erf.
struct Facets {
    bool beckmann;
    double alpha;

    double density(double cosine) const {
        if (cosine <= 0) return 0;
        const double c2 = cosine * cosine, tan2 = (1 - c2) / c2, a2 = alpha * alpha;
        if (beckmann) return std::exp(-tan2 / a2) / (pi * a2 * c2 * c2);
        return a2 / (pi * c2 * c2 * (a2 + tan2) * (a2 + tan2));
    }
    double masking(const Vector& v, const Vector& m) const {
        if (dot3(v, m) * v[2] <= 0) return 0;
        const double z = std::abs(v[2]), tangent = std::sqrt(std::max(1 - z * z, 0.0)) / z;
        if (tangent == 0) return 1;
        if (!beckmann) return 2 / (1 + std::sqrt(1 + alpha * alpha * tangent * tangent));
        const double a = 1 / (alpha * tangent);
        return 2 / (1 + std::erf(a) + std::exp(-a * a) / (a * std::sqrt(pi)));
    }
};

/// Eq. 21, of the true outgoing direction, below the surface, and the smaller cosine of the angles
/// that the two directions have with the facet: Eq. 21 goes to zero with it, and the rounding of
/// the directions divided by it is the relative error that no evaluation can be without.
struct Expected {
    double value = 0, cosine = 1;
};
Expected walter(const Facets& facets, double ni, double no, const Vector& i, const Vector& o) {
    Vector h;
    for (int k = 0; k < 3; ++k) h[k] = -(ni * i[k] + no * o[k]);
    const double length = std::sqrt(dot3(h, h)), sign = h[2] < 0 ? -1 : 1;
    // The macro surface's normal is +z: facets that face it.
    for (double& value : h) value *= sign / length;
    if (dot3(i, h) <= 0 || dot3(o, h) >= 0) return {};
    const double ih = dot3(i, h), oh = dot3(o, h);
    // F for light that comes from the side of the smaller index: there its square root is of no
    // small difference (F is the same both ways, by Stokes).
    const double reflected = ni < no ? fresnel(ih, no / ni) : fresnel(-oh, ni / no);
    return {std::abs(ih * oh) / std::abs(i[2] * o[2]) * no * no * (1 - reflected) *
                facets.masking(i, h) * facets.masking(o, h) * facets.density(h[2]) /
                std::pow(ni * ih + no * oh, 2),
            std::min(ih, -oh)};
}

std::string specOf(const Facets& facets, double ior, bool front) {
    return fmt::format("rough-glass:alpha={},ior={},distribution={},side=transmission-{}",
                       facets.alpha, ior, facets.beckmann ? "beckmann" : "ggx",
                       front ? "front" : "back");
}

constexpr Facets kinds[] = {{false, .05}, {false, .3}, {false, .8}, {true, .05}, {true, .4}};

TEST(RoughGlass, IsEquation21) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto draw = [&] {
        const double phi = 2 * pi * unit(random);
        return directionFromAngles(std::acos(unit(random)), phi);
    };
    int lit = 0;
    for (const Facets& facets : kinds)
        for (const double ior : {1.2, 1.5, 2.4})
            for (const bool front : {true, false}) {
                const auto brdf = brdfs::open(specOf(facets, ior, front));
                for (int k = 0; k < 2000; ++k) {
                    const Direction wi = draw(), wo = draw();
                    const Expected expected = walter(facets, front ? 1 : ior, front ? ior : 1,
                                                     vectorOf(wi), vectorOf(throughSurface(wo)));
                    const double found = evaluate(*brdf, wi, wo)[0];
                    ASSERT_NEAR(found, expected.value,
                                expected.value * (1e-12 + 1e-15 / expected.cosine) + 1e-20)
                        << brdf->name();
                    lit += expected.value > 0;
                }
            }
    EXPECT_GT(lit, 10000);
}

/// Reflected and transmitted shares of light from wi: sums over the facets' normals, equally many
/// for equal shares of D(m) cos(theta_m), of Eq. 20 and 21 without their Jacobians.
std::array<double, 2> sharesOf(const Facets& facets, double ni, double no, const Vector& i) {
    constexpr int radial = 3000, around = 720;
    std::array<double, 2> shares{};
    for (int r = 0; r < radial; ++r) {
        // 1 - u = v^2: the weight of upright facets is unbounded in u, not in v.
        const double v = (r + 0.5) / radial, rest = v * v, a2 = facets.alpha * facets.alpha;
        const double tan2 = facets.beckmann ? -a2 * std::log(rest) : a2 * (1 - rest) / rest;
        const double cosine = 1 / std::sqrt(1 + tan2), sine = std::sqrt(tan2) * cosine;
        for (int k = 0; k < around; ++k) {
            const double phi = 2 * pi * (k + 0.5) / around;
            const Vector m{sine * std::cos(phi), sine * std::sin(phi), cosine};
            const double im = dot3(i, m);
            if (im <= 0) continue;
            const double weight = 2 * v * im / (i[2] * cosine) * facets.masking(i, m);
            const double F = fresnel(im, no / ni), eta = ni / no;
            Vector reflected, refracted;
            const double root = std::sqrt(std::max(1 + eta * eta * (im * im - 1), 0.0));
            for (int j = 0; j < 3; ++j) {
                reflected[j] = 2 * im * m[j] - i[j];
                refracted[j] = (eta * im - root) * m[j] - eta * i[j];  // Eq. 40
            }
            if (reflected[2] > 0) shares[0] += weight * F * facets.masking(reflected, m);
            if (F < 1 && refracted[2] < 0)
                shares[1] += weight * (1 - F) * facets.masking(refracted, m);
        }
    }
    for (double& share : shares) share /= static_cast<double>(radial) * around;
    return shares;
}

TEST(RoughGlass, EnergyWithReflectionIsThatOfThePublishedModel) {
    for (const Facets& facets : kinds)
        for (const double theta : {0.0, 35.0, 70.0}) {
            const Direction wi = directionFromAngles(radians(theta), .3);
            const auto [reflected, sent] = sharesOf(facets, 1, 1.5, vectorOf(wi));
            const auto glass = brdfs::open(specOf(facets, 1.5, true));
            SCOPED_TRACE(fmt::format("{} at {}", glass->name(), theta));
            const auto mirror =
                brdfs::open(fmt::format("{}:alpha={},fresnel=dielectric,ior=1.5,masking=separable",
                                        facets.beckmann ? "beckmann" : "ggx", facets.alpha));
            const double transmittance = directionalReflectance(*glass, wi, 1e-6)[0];
            const double reflectance = directionalReflectance(*mirror, wi, 1e-6)[0];
            EXPECT_NEAR(transmittance, sent, 1e-4);
            EXPECT_NEAR(transmittance + reflectance, reflected + sent, 1e-4);
            EXPECT_LE(transmittance + reflectance, 1 + 1e-6);
            // From inside, with total reflection.
            const double out =
                directionalReflectance(*brdfs::open(specOf(facets, 1.5, false)), wi, 1e-6)[0];
            EXPECT_NEAR(out, sharesOf(facets, 1.5, 1, vectorOf(wi))[1], 1e-4);
        }
}

TEST(RoughGlass, SmoothGlassHasFresnelTransmittance) {
    for (const bool beckmann : {false, true})
        for (const double theta : {0.0, 30.0, 60.0}) {
            const Facets facets{beckmann, 1e-3};
            const Direction wi = directionFromAngles(radians(theta), .3);
            const double transmittance = 1 - fresnel(wi.z, 1.5);
            const auto glass = brdfs::open(specOf(facets, 1.5, true));
            SCOPED_TRACE(fmt::format("{} at {}", glass->name(), theta));
            EXPECT_NEAR(directionalReflectance(*glass, wi, 1e-6)[0], transmittance, 2e-5);
            // Radiance gains the square of the index where light enters the glass.
            const double s = std::sin(radians(theta)) / 1.5;
            const Direction wo{-s * std::cos(.3), -s * std::sin(.3), std::sqrt(1 - s * s)};
            EXPECT_NEAR(directionalAlbedo(*glass, wo, 1e-6)[0], 2.25 * transmittance, 2e-4);
        }
    // Beyond the critical angle, 41.8 degrees, nothing leaves the glass.
    const auto inside = brdfs::open(specOf({false, 1e-3}, 1.5, false));
    EXPECT_LE(directionalReflectance(*inside, directionFromAngles(radians(50), 0), 1e-4)[0], 1e-3);
}

// f(i, o) / n_o^2 = f(o, i) / n_i^2: the light of the way back comes from the other side.
TEST(RoughGlass, BothSidesAreReciprocal) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const Facets& facets : kinds) {
        const auto front = brdfs::open(specOf(facets, 1.5, true)),
                   back = brdfs::open(specOf(facets, 1.5, false));
        EXPECT_FALSE(front->laws().reciprocal);
        for (int k = 0; k < 500; ++k) {
            const Direction wi = directionFromAngles(std::acos(unit(random)), 6 * unit(random)),
                            wo = directionFromAngles(std::acos(unit(random)), 6 * unit(random));
            const double there = evaluate(*front, wi, wo)[0];
            ASSERT_NEAR(there, 2.25 * evaluate(*back, wo, wi)[0], 1e-9 * there + 1e-20);
        }
    }
}

TEST(RoughGlass, ADiffuserSendsItsShare) {
    const auto paper = brdfs::open("lambert-transmission:kt=.4,side=transmission-back");
    EXPECT_EQ(transmissionSide(paper->name()), "transmission-back");
    EXPECT_NEAR(directionalReflectance(*paper, {.6, 0, .8})[0], .4, 1e-6);
    EXPECT_NEAR(evaluate(*paper, {.6, 0, .8}, {0, 0, 1})[0], .4 / pi, 1e-15);
}

}  // namespace
}  // namespace hshfit
