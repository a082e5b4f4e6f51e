// The film of the standard materials: against Airy's sum over the CIE curves, wavelength by
// wavelength, against the extension's listing as printed, and as a law of both models.

#include "models_angles.h"

#include <brdfs/analytic/thin_film.h>
#include <hshfit/brdf/internal/cie_1931.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>

namespace hshfit::brdfs {
namespace {

using Rgb = std::array<double, 3>;
using Spectrum = std::function<double(double nanometres)>;

/// Rec. 709 from XYZ, IEC 61966-2-1's primaries to more digits (Lindbloom).
constexpr double rec709[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                 {-0.9692660, 1.8760108, 0.0415560},
                                 {0.0556434, -0.2040259, 1.0572252}};

double f0Of(double index) {
    return square((index - 1) / (index + 1));
}

/// R, G and B of a reflectance spectrum under light of equal energy, by the CIE curves in steps of
/// 0.5 nm, in units of Y of a perfect reflector.
Rgb overCurves(const Spectrum& spectrum) {
    constexpr int parts = 10;
    double xyz[3] = {}, white = 0;
    for (std::size_t k = 0; k + 1 < cie1931.size(); ++k) {
        for (int i = 0; i < parts; ++i) {
            const double t = (i + 0.5) / parts;
            const CieRow &a = cie1931[k], &b = cie1931[k + 1];
            const double y = std::lerp(a.y, b.y, t);
            const double r = spectrum(cieFirst + cieStep * (static_cast<double>(k) + t));
            xyz[0] += std::lerp(a.x, b.x, t) * r;
            xyz[1] += y * r;
            xyz[2] += std::lerp(a.z, b.z, t) * r;
            white += y;
        }
    }
    Rgb rgb{};
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) rgb[c] += rec709[c][i] * xyz[i] / white;
    return rgb;
}

/// The two boundaries by Schlick's reflectances, which the extension has: amplitudes.
struct Boundaries {
    double top, base, below;

    Boundaries(double cosine, double ior, double index)
        : below(std::sqrt(1 - (1 - cosine * cosine) / (ior * ior))) {
        const auto schlick = [](double f0, double c) { return f0 + (1 - f0) * std::pow(1 - c, 5); };
        top = -std::sqrt(schlick(f0Of(ior), cosine));
        base = std::copysign(std::sqrt(schlick(f0Of(index / ior), below)), ior - index);
    }
    /// |r|^2 of all reflections between them: Airy's sum.
    double airy(double ior, double nanometres, double wavelength) const {
        const double phase = 4 * pi * ior * nanometres * below / wavelength;
        const std::complex<double> turn = std::polar(1., phase);
        return std::norm((top + base * turn) / (1. + top * base * turn));
    }
    /// Its mean over the phase.
    double mean() const {
        const double r = top * top, s = base * base;
        return r + (1 - r) * (1 - r) * s / (1 - r * s);
    }
};

/// Airy's sum by Fresnel's equations, the mean of both polarisations.
double fresnelAiry(double c, double ior, double index, double nanometres, double wavelength) {
    const double sine2 = 1 - c * c, c2 = std::sqrt(1 - sine2 / (ior * ior)),
                 c3 = std::sqrt(1 - sine2 / (index * index));
    const std::complex<double> turn = std::polar(1., 4 * pi * ior * nanometres * c2 / wavelength);
    const auto sum = [&](double top, double base) {
        return std::norm((top + base * turn) / (1. + top * base * turn));
    };
    return 0.5 * (sum((c - ior * c2) / (c + ior * c2),
                      (ior * c2 - index * c3) / (ior * c2 + index * c3)) +
                  sum((ior * c - c2) / (ior * c + c2),
                      (index * c2 - ior * c3) / (index * c2 + ior * c3)));
}

struct Errors {
    double largest = 0, squares = 0;
    std::size_t count = 0;

    void add(const Rgb& a, const Rgb& b) {
        for (int c = 0; c < 3; ++c) {
            largest = std::max(largest, std::abs(a[c] - b[c]));
            squares += square(a[c] - b[c]);
            ++count;
        }
    }
    double rms() const { return std::sqrt(squares / static_cast<double>(count)); }
};

/// Over thicknesses of 50 to 1000 nm and angles of 0 to 70 degrees.
template <class Exact>
Errors errorsOf(double ior, double index, const Exact& exact) {
    const double f0 = f0Of(index);
    Errors errors;
    for (int nanometres = 50; nanometres <= 1000; nanometres += 25)
        for (const double theta : {0, 30, 50, 70}) {
            const double cosine = std::cos(radians(theta));
            errors.add(thinFilmReflectance(cosine, ior, nanometres, {f0, f0, f0}),
                       exact(cosine, static_cast<double>(nanometres)));
        }
    return errors;
}

/// With the extension's boundaries, so that what is left is the fit of the curves by Gaussians and
/// the reflections of third order on.
Errors errorsOfGaussians(double ior, double index, double thicker = 1) {
    return errorsOf(ior, index, [&](double cosine, double nanometres) {
        const Boundaries both(cosine, ior, index);
        Rgb rgb = overCurves(
            [&](double w) { return both.airy(ior, thicker * nanometres, w) - both.mean(); });
        for (double& c : rgb) c = std::clamp(c + both.mean(), 0., 1.);
        return rgb;
    });
}

/// Against Fresnel's equations, the colours in units of a perfect reflector's.
Errors errorsAgainstFresnel(double ior, double index) {
    const Rgb white = overCurves([](double) { return 1; });
    return errorsOf(ior, index, [&](double cosine, double nanometres) {
        Rgb rgb =
            overCurves([&](double w) { return fresnelAiry(cosine, ior, index, nanometres, w); });
        for (int c = 0; c < 3; ++c) rgb[c] /= white[c];
        return rgb;
    });
}

// The bounds are the accuracy that standard_materials.md states.
TEST(ThinFilm, IsAirysSumOverTheCieCurvesUpToTheFitOfTheseCurves) {
    for (const double index : {1.5, 2.5, 4.})
        for (const double ior : {1.3, 1.8, 2.4}) {
            const Errors errors = errorsOfGaussians(ior, index);
            EXPECT_LT(errors.largest, 0.05) << index << " under " << ior;
            EXPECT_LT(errors.rms(), 0.014) << index << " under " << ior;
        }
    EXPECT_GT(errorsOfGaussians(1.3, 4, 1.05).rms(), 0.03);
}

TEST(ThinFilm, DiffersFromFresnelsEquationsByWhatIsStated) {
    for (const double ior : {1.3, 1.8, 2.4}) {
        EXPECT_LT(errorsAgainstFresnel(ior, 1.5).rms(), 0.031) << ior;
        EXPECT_LT(errorsAgainstFresnel(ior, 2.5).rms(), 0.04) << ior;
        EXPECT_LT(errorsAgainstFresnel(ior, 4).rms(), 0.072) << ior;
    }
    EXPECT_LT(errorsAgainstFresnel(1.3, 1.5).largest, 0.055);
    EXPECT_LT(errorsAgainstFresnel(1.3, 4).largest, 0.35);
}

TEST(ThinFilm, IsAReflectanceForEveryFilm) {
    for (const double nanometres : {0., 1e-9, 0.02, 1., 80., 400., 1500., 1e4})
        for (const double ior : {1., 1 + 1e-12, 1.3, 2., 3.})
            for (const double f0 : {0., 1e-12, 0.04, 0.6, 1.})
                for (const double cosine : {1., 0.5, 1e-3, 1e-9, 0.}) {
                    const Rgb r = thinFilmReflectance(cosine, ior, nanometres, {f0, 0.04, f0});
                    for (const double c : r)
                        EXPECT_TRUE(c >= 0 && c <= 1) << nanometres << " nm, " << ior << ", " << f0;
                }
}

// The extension bounds the product of both reflectances from below by 1e-5, whose root is 0.003;
// and Schlick's form rises to 1 at grazing angles whatever the index, so that this holds at the
// normal.
TEST(ThinFilm, AFilmOfNoThicknessIsNoneAtTheNormal) {
    for (const double f0 : {0.02, 0.3, 0.9})
        for (const double c : thinFilmReflectance(1, 2, 1e-6, {f0, f0, f0}))
            EXPECT_NEAR(c, f0, 0.01);
}

TEST(ThinFilm, AThickFilmHasTheMeanOverItsPhases) {
    for (const double cosine : {1., 0.6, 0.2}) {
        const double mean = Boundaries(cosine, 1.4, 2.5).mean();
        for (const double c :
             thinFilmReflectance(cosine, 1.4, 1e4, {f0Of(2.5), f0Of(2.5), f0Of(2.5)}))
            EXPECT_NEAR(c, mean, 1e-9);
    }
}

TEST(ThinFilm, IsAbsentWithoutWeightOrThickness) {
    const std::pair<const char*, const char*> films[] = {
        {"gltf-pbr:baseColorFactor=.9/.5/.1,metallicFactor=.4,roughnessFactor=.4",
         "iridescenceFactor=0,iridescenceIor=2"},
        {"gltf-pbr:baseColorFactor=.9/.5/.1,metallicFactor=.4,roughnessFactor=.4",
         "iridescenceFactor=1,iridescenceThickness=0"},
        {"openpbr:base_color=.9/.5/.1,base_metalness=.4,coat_weight=.5", "thin_film_ior=2"},
        {"openpbr:base_color=.9/.5/.1,base_metalness=.4,coat_weight=.5",
         "thin_film_weight=1,thin_film_thickness=0"}};
    for (const auto& [spec, film] : films) {
        const auto bare = open(spec), with = open(fmt::format("{},{}", spec, film));
        for (const Pair& p : ordinaryPairs(5))
            EXPECT_EQ(evaluate(*with, p.wi, p.wo), evaluate(*bare, p.wi, p.wo)) << film;
    }
}

}  // namespace
}  // namespace hshfit::brdfs
