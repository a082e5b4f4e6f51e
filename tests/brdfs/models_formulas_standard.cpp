// The materials of glTF and OpenPBR against their specifications' formulas, written as they are
// printed: glTF 2.0 appendix B, but for its masking, with its extensions' "Implementation"
// sections, and the reference graph of OpenPBR 1.1 in MaterialX 1.39, but for its film.

#include "models_angles.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hshfit/projection/albedo.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Vector = std::array<double, 3>;

Vector vectorOf(const Direction& d) {
    return {d.x, d.y, d.z};
}
double dotOf(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector halfOf(const Pair& p) {
    Vector h{p.wi.x + p.wo.x, p.wi.y + p.wo.y, p.wi.z + p.wo.z};
    const double length = std::sqrt(dotOf(h, h));
    for (double& c : h) c /= length;
    return h;
}
double mix(double a, double b, double t) {
    return a * (1 - t) + b * t;
}

/// D V of the listing in KHR_materials_anisotropy; with at = ab, D V of viewers without it.
double anisotropicLobe(const Pair& p, double at, double ab, double rotation) {
    const Vector t{std::cos(rotation), std::sin(rotation), 0},
        b{-std::sin(rotation), std::cos(rotation), 0};
    const Vector l = vectorOf(p.wi), v = vectorOf(p.wo), h = halfOf(p);
    const double a2 = at * ab;
    const Vector f{ab * dotOf(t, h), at * dotOf(b, h), a2 * h[2]};
    const double w2 = a2 / dotOf(f, f), d = a2 * w2 * w2 / pi;
    const auto length = [&](const Vector& w) {
        const Vector s{at * dotOf(t, w), ab * dotOf(b, w), w[2]};
        return std::sqrt(dotOf(s, s));
    };
    return d * 0.5 / (l[2] * length(v) + v[2] * length(l));
}

/// Appendix B's D with the V of its viewers, whose masking is of correlated heights.
double viewerLobe(const Pair& p, double alpha) {
    const double a2 = alpha * alpha, nh = halfOf(p)[2], nl = p.wi.z, nv = p.wo.z;
    const double d = a2 / (pi * square(nh * nh * (a2 - 1) + 1));
    return d * 0.5 /
           (nl * std::sqrt(a2 + (1 - a2) * nv * nv) + nv * std::sqrt(a2 + (1 - a2) * nl * nl));
}

/// Appendix B's D and V as printed: G is the product of 2 n.w / (n.w + sqrt(a^2 + (1 - a^2)
/// (n.w)^2)) over both directions w.
double printedLobe(const Pair& p, double alpha) {
    const double a2 = alpha * alpha, nh = halfOf(p)[2];
    double visibility = 0.25;
    for (const double c : {p.wi.z, p.wo.z})
        visibility *= 2 / (c + std::sqrt(a2 + (1 - a2) * c * c));
    return visibility * a2 / (pi * square(nh * nh * (a2 - 1) + 1));
}

double schlick(double f0, double cosine) {
    return f0 + (1 - f0) * std::pow(1 - cosine, 5);
}

void expectClose(const std::string& spec, const std::function<Vector(const Pair&)>& formula,
                 double tolerance = 1e-9) {
    const auto brdf = open(spec);
    for (const Pair& p : ordinaryPairs(5)) {
        if (p.wi.z < 0.02 || p.wo.z < 0.02) continue;
        const std::vector<double> f = evaluate(*brdf, p.wi, p.wo);
        const Vector expected = formula(p);
        for (std::size_t c = 0; c < f.size(); ++c)
            EXPECT_NEAR(f[c], expected[c], tolerance * (1 + std::abs(expected[c])))
                << spec << " channel " << c << " wi.z " << p.wi.z << " wo.z " << p.wo.z;
    }
}

// At 80 degrees on either side of the normal and roughness 1: D = 1/pi, and with c = cos 80 degrees
// V is 1 / (4 c) of correlated heights and 1 / (1 + c)^2 as printed.
TEST(GltfPbr, MaskingIsThatOfTheViewersAndNotTheOneOfAppendixB) {
    const double c = std::cos(radians(80));
    const Pair p{directionFromAngles(radians(80), pi), directionFromAngles(radians(80), 0)};
    EXPECT_NEAR(viewerLobe(p, 1), 1 / (4 * c * pi), 1e-12);
    EXPECT_NEAR(printedLobe(p, 1), 1 / ((1 + c) * (1 + c) * pi), 1e-12);
    const auto metal = open("gltf-pbr:metallicFactor=1,roughnessFactor=1");
    EXPECT_NEAR(evaluate(*metal, p.wi, p.wo)[0], 0.4583, 5e-5);
    EXPECT_NEAR(printedLobe(p, 1), 0.2311, 5e-5);
}

TEST(StandardMaterials, GltfBaseIsAppendixB) {
    const Vector base{0.9, 0.5, 0.1};
    for (const double metallic : {0., 0.3, 1.}) {
        for (const double roughness : {0.2, 0.5, 1.}) {
            expectClose(fmt::format("gltf-pbr:baseColorFactor=.9/.5/.1,metallicFactor={},"
                                    "roughnessFactor={}",
                                    metallic, roughness),
                        [&](const Pair& p) {
                            const double cosine = dotOf(vectorOf(p.wo), halfOf(p));
                            const double lobe = viewerLobe(p, roughness * roughness);
                            Vector f;
                            for (int c = 0; c < 3; ++c) {
                                const double metal = lobe * schlick(base[c], cosine);
                                const double dielectric =
                                    mix(base[c] / pi, lobe, schlick(0.04, cosine));
                                f[c] = mix(dielectric, metal, metallic);
                            }
                            return f;
                        });
        }
    }
}

// KHR_materials_specular's fresnel_mix: the base loses the largest channel.
TEST(StandardMaterials, GltfIorSpecularAndAnisotropyAreTheExtensions) {
    const Vector base{0.2, 0.6, 0.4}, tint{1, 0.5, 0.2};
    const double ior = 1.8, factor = 0.7, metallic = 0.25, strength = 0.6, rotation = 0.8;
    const double alpha = 0.16, along = mix(alpha, 1, strength * strength);
    expectClose(
        "gltf-pbr:baseColorFactor=.2/.6/.4,metallicFactor=.25,roughnessFactor=.4,ior=1.8,"
        "specularFactor=.7,specularColorFactor=1/.5/.2,anisotropyStrength=.6,"
        "anisotropyRotation=.8",
        [&](const Pair& p) {
            const double cosine = dotOf(vectorOf(p.wo), halfOf(p));
            const double lobe = anisotropicLobe(p, along, alpha, rotation);
            Vector fresnel, f;
            for (int c = 0; c < 3; ++c)
                fresnel[c] = schlick(std::min(square((1 - ior) / (1 + ior)) * tint[c], 1.), cosine);
            const double largest = *std::ranges::max_element(fresnel);
            for (int c = 0; c < 3; ++c) {
                const double dielectric =
                    (1 - factor * largest) * base[c] / pi + factor * fresnel[c] * lobe;
                f[c] = mix(dielectric, lobe * schlick(base[c], cosine), metallic);
            }
            return f;
        });
}

// The albedo E of the sheen is the library's adaptive quadrature, cut at 1.
TEST(StandardMaterials, GltfSheenAndClearcoatAreTheExtensions) {
    const Vector sheen{0.5, 0.3, 0.8};
    const double sheenRoughness = 0.6, clearcoat = 0.8, coatRoughness = 0.25, roughness = 0.7;
    const auto lobe = open(fmt::format("charlie:r={}", sheenRoughness * sheenRoughness));
    const auto albedo = [&](const Direction& w) {
        return std::min(1., directionalAlbedo(*lobe, w, 1e-4)[0]);
    };
    expectClose(
        "gltf-pbr:baseColorFactor=.6,metallicFactor=0,roughnessFactor=.7,"
        "sheenColorFactor=.5/.3/.8,sheenRoughnessFactor=.6,clearcoatFactor=.8,"
        "clearcoatRoughnessFactor=.25",
        [&](const Pair& p) {
            const double cosine = dotOf(vectorOf(p.wo), halfOf(p));
            const double base =
                mix(0.6 / pi, viewerLobe(p, roughness * roughness), schlick(0.04, cosine));
            const double scale = std::min(1 - 0.8 * albedo(p.wo), 1 - 0.8 * albedo(p.wi));
            const double cloth = evaluate(*lobe, p.wi, p.wo)[0];
            const double coat = clearcoat * schlick(0.04, p.wo.z);
            Vector f;
            for (int c = 0; c < 3; ++c)
                f[c] = mix(sheen[c] * cloth + base * scale,
                           viewerLobe(p, coatRoughness * coatRoughness), coat);
            return f;
        },
        2e-3);
}

double dielectric(double c, double ior) {
    const double g = std::sqrt(ior * ior + c * c - 1);
    return 0.5 * square((g - c) / (g + c)) * (1 + square(((g + c) * c - 1) / ((g - c) * c + 1)));
}

TEST(StandardMaterials, OpenpbrMetalIsSchlickBentAt82Degrees) {
    const Vector base{0.9, 0.6, 0.3}, edge{1, 0.7, 0.4};
    const double weight = 0.8, specular = 0.9, roughness = 0.4, anisotropy = 0.5, turn = 0.8;
    const double along = square(roughness) * std::sqrt(2 / (1 + square(1 - anisotropy)));
    expectClose(
        "openpbr:base_color=.9/.6/.3,base_weight=.8,base_metalness=1,specular_weight=.9,"
        "specular_color=1/.7/.4,specular_roughness=.4,specular_roughness_anisotropy=.5,"
        "geometry_tangent=.8",
        [&](const Pair& p) {
            const double c = dotOf(vectorOf(p.wo), halfOf(p));
            const double lobe = anisotropicLobe(p, along, (1 - anisotropy) * along, turn);
            Vector f;
            for (int k = 0; k < 3; ++k) {
                const double f0 = weight * base[k], max = 1. / 7;
                const double a =
                    schlick(f0, max) * (1 - specular * edge[k]) / (max * std::pow(1 - max, 6));
                f[k] =
                    std::max(0., specular * lobe * (schlick(f0, c) - a * c * std::pow(1 - c, 6)));
            }
            return f;
        });
}

// The base's share is what the albedo of the layer above it, by the library's own quadrature of an
// equal lobe, leaves.
TEST(StandardMaterials, OpenpbrDielectricIsLayeredByAlbedo) {
    const Vector tint{1, 0.8, 0.6};
    const double specular = 0.6, ior = 1.7, roughness = 0.5;
    const double root = std::sqrt(specular * square((ior - 1) / (ior + 1)));
    const double eta = (1 + root) / (1 - root);
    const auto eon = open("eon:kd=.8/.5/.2,roughness=.4");
    const auto facets = open(
        fmt::format("ggx:alpha={},fresnel=dielectric,ior={:.17g}", roughness * roughness, eta));
    expectClose(
        "openpbr:base_color=.8/.5/.2,base_diffuse_roughness=.4,specular_weight=.6,"
        "specular_color=1/.8/.6,specular_ior=1.7,specular_roughness=.5",
        [&](const Pair& p) {
            const double c = dotOf(vectorOf(p.wo), halfOf(p));
            const double lobe = viewerLobe(p, roughness * roughness) * dielectric(c, eta);
            const double left = 1 - directionalAlbedo(*facets, p.wo, 1e-4)[0];
            const std::vector<double> under = evaluate(*eon, p.wi, p.wo);
            Vector f;
            for (int k = 0; k < 3; ++k) f[k] = tint[k] * lobe + left * under[k];
            return f;
        },
        2e-3);
}

TEST(StandardMaterials, OpenpbrCoatAndFuzzLieAboveTheBase) {
    const double coatWeight = 0.7, coatIor = 1.6, coatRoughness = 0.3, darkening = 0.5;
    const double fuzzWeight = 0.4, y = 0.5, base = 0.6, metalRoughness = 0.5;
    const Vector coatColour{0.9, 0.7, 0.5}, fuzzColour{0.2, 0.5, 1};
    const double fourth = std::pow(metalRoughness, 4) + 2 * std::pow(coatRoughness, 4);
    const double rough = mix(metalRoughness, std::pow(std::min(1., fourth), 0.25), coatWeight);
    const double inside = 1 - (1 - square((coatIor - 1) / (coatIor + 1))) / square(coatIor);
    const auto facets =
        open(fmt::format("ggx:alpha={},fresnel=dielectric,ior={}", square(coatRoughness), coatIor));
    expectClose(
        "openpbr:base_color=.6,base_metalness=1,specular_roughness=.5,coat_weight=.7,"
        "coat_color=.9/.7/.5,coat_roughness=.3,coat_darkening=.5,fuzz_weight=.4,"
        "fuzz_color=.2/.5/1,fuzz_roughness=.5",
        [&](const Pair& p) {
            const double c = dotOf(vectorOf(p.wo), halfOf(p)), x = p.wo.z;
            // Zeltner's lobe in the plane of wo, as in MaterialX.
            const double sine = std::hypot(p.wo.x, p.wo.y);
            const double wx = (p.wi.x * p.wo.x + p.wi.y * p.wo.y) / sine,
                         wy = (p.wi.y * p.wo.x - p.wi.x * p.wo.y) / sine;
            const double s = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
            const double m =
                y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
            const double o = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) /
                             (1.26264 + y * (-1.92021 + y));
            const double cloth = std::exp(-0.5 * square((x - m) / s)) / (s * std::sqrt(2 * pi)) + o;
            const double a =
                (2.58126 * x + 0.813703 * y) * y / (1 + 0.310327 * x * x + 2.60994 * x * y);
            const double b = std::sqrt(1 - x) * (y - 1) * y * y * y /
                             (0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y * y);
            const double squared = square(a * wx + b * p.wi.z) + square(a * wy) + square(p.wi.z);
            const double fuzz = cloth * square(a / squared) / pi;
            const double coat =
                coatWeight * viewerLobe(p, square(coatRoughness)) * dielectric(c, coatIor);
            const double left = 1 - coatWeight * directionalAlbedo(*facets, p.wo, 1e-4)[0];
            const double metal = viewerLobe(p, square(rough)) * schlick(base, c);
            const double dark = mix(1, (1 - inside) / (1 - base * inside), coatWeight * darkening);
            Vector f;
            for (int k = 0; k < 3; ++k) {
                const double under = mix(1, coatColour[k], coatWeight) * dark * metal;
                f[k] = fuzzWeight * fuzzColour[k] * fuzz +
                       (1 - fuzzWeight * cloth) * (coat + left * under);
            }
            return f;
        },
        2e-3);
}

/// `iridescent_fresnel` of KHR_materials_iridescence as printed, but for a base of F0 = 1, with a
/// cut at 1. R, G and B each have the phase of their own base.
Vector iridescentFresnel(double outside, double ior, const Vector& baseF0, double thickness,
                         double cosine) {
    constexpr double toRgb[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                    {-0.9692660, 1.8760108, 0.0415560},
                                    {0.0556434, -0.2040259, 1.0572252}};
    const double sine2 = square(outside / ior) * (1 - cosine * cosine);
    const double cosine2 = std::sqrt(1 - sine2), path = 2 * ior * thickness * cosine2;
    const double r12 = schlick(square((ior - outside) / (ior + outside)), cosine), t121 = 1 - r12;
    Vector result;
    for (int c = 0; c < 3; ++c) {
        const double root = std::sqrt(baseF0[c]), index = (1 + root) / (1 - root);
        const double r23 = schlick(square((index - ior) / (index + ior)), cosine2);
        const double phi = pi + (index < ior ? pi : 0);
        const double r123 = std::clamp(r12 * r23, 1e-5, 0.9999);
        const double rs = square(t121) * r23 / (1 - r123);
        double cm = rs - t121;
        result[c] = r12 + rs;
        for (int m = 1; m <= 2; ++m) {
            cm *= std::sqrt(r123);
            const double phase = 2 * pi * m * path * 1e-9, shift = m * phi;
            const auto gaussian = [&](double val, double pos, double var) {
                return val * std::sqrt(2 * pi * var) * std::cos(pos * phase + shift) *
                       std::exp(-square(phase) * var) / 1.0685e-7;
            };
            const double x = gaussian(5.4856e-13, 1.6810e6, 4.3278e9) +
                             gaussian(9.7470e-14, 2.2399e6, 4.5282e9),
                         y = gaussian(4.4201e-13, 1.7953e6, 9.3046e9),
                         z = gaussian(5.2481e-13, 2.2084e6, 6.6121e9);
            result[c] += cm * 2 * (toRgb[c][0] * x + toRgb[c][1] * y + toRgb[c][2] * z);
        }
        result[c] = std::clamp(result[c], 0., 1.);
    }
    return result;
}

TEST(StandardMaterials, GltfIridescenceIsTheExtension) {
    const Vector base{0.8, 0.5, 0.2}, tint{1, 0.5, 0.2};
    const double ior = 1.8, specular = 0.7, metallic = 0.25, alpha = 0.16;
    for (const double thickness : {150., 400., 900.})
        for (const double film : {1.2, 1.45, 1.9})
            for (const double strength : {0.4, 1.})
                expectClose(
                    fmt::format("gltf-pbr:baseColorFactor=.8/.5/.2,metallicFactor=.25,"
                                "roughnessFactor=.4,ior=1.8,specularFactor=.7,"
                                "specularColorFactor=1/.5/.2,iridescenceFactor={},"
                                "iridescenceIor={},iridescenceThickness={}",
                                strength, film, thickness),
                    [&](const Pair& p) {
                        const double cosine = dotOf(vectorOf(p.wo), halfOf(p));
                        const double lobe = viewerLobe(p, alpha);
                        Vector f0, alphas, f;
                        for (int c = 0; c < 3; ++c)
                            f0[c] = square((1 - ior) / (1 + ior)) * tint[c] * specular;
                        const Vector under = iridescentFresnel(1, film, f0, thickness, cosine);
                        const Vector metal = iridescentFresnel(1, film, base, thickness, cosine);
                        for (int c = 0; c < 3; ++c)
                            alphas[c] = mix(specular * schlick(f0[c] / specular, cosine), under[c],
                                            strength);
                        const double largest = *std::ranges::max_element(alphas);
                        for (int c = 0; c < 3; ++c)
                            f[c] = mix((1 - largest) * base[c] / pi + alphas[c] * lobe,
                                       lobe * mix(schlick(base[c], cosine), metal[c], strength),
                                       metallic);
                        return f;
                    });
}

TEST(StandardMaterials, OpenpbrThinFilmIsThatOfGltfOnTheFacetsOfTheBase) {
    const Vector base{0.9, 0.6, 0.3};
    const double specular = 0.9, ior = 1.5, weight = 0.6;
    const double root = std::sqrt(specular * square((ior - 1) / (ior + 1)));
    const double f0 = square(root), eta = (1 + root) / (1 - root);
    const auto facets = open(fmt::format("ggx:alpha=.25,fresnel=dielectric,ior={:.17g}", eta));
    for (const double metalness : {0., 0.4, 1.})
        expectClose(
            fmt::format("openpbr:base_color=.9/.6/.3,base_metalness={},specular_weight=.9,"
                        "specular_roughness=.5,thin_film_weight=.6,thin_film_ior=1.8,"
                        "thin_film_thickness=.45",
                        metalness),
            [&](const Pair& p) {
                const double cosine = dotOf(vectorOf(p.wo), halfOf(p)), lobe = viewerLobe(p, 0.25);
                const double left = 1 - directionalAlbedo(*facets, p.wo, 1e-4)[0], max = 1. / 7;
                const Vector metal = iridescentFresnel(1, 1.8, base, 450, cosine);
                const Vector under = iridescentFresnel(1, 1.8, {f0, f0, f0}, 450, cosine);
                Vector f;
                for (int k = 0; k < 3; ++k) {
                    const double bend = schlick(base[k], max) * (1 - specular) /
                                        (max * std::pow(1 - max, 6)) * cosine *
                                        std::pow(1 - cosine, 6);
                    const double bare = schlick(base[k], cosine) - bend;
                    f[k] = mix(
                        left * base[k] / pi + lobe * mix(dielectric(cosine, eta), under[k], weight),
                        specular * lobe * mix(bare, metal[k], weight), metalness);
                }
                return f;
            },
            2e-3);
}

// Every part at its defaults leaves the model without it.
TEST(StandardMaterials, PartsAreAbsentAtTheirDefaults) {
    for (const Model& model : models()) {
        for (const ModelPart& part : model.parts) {
            std::string spec(model.name);
            for (const std::string_view key : part.parameters) {
                const auto row = std::ranges::find(model.parameters, key, &Parameter::name);
                ASSERT_NE(row, model.parameters.end()) << key;
                ASSERT_TRUE(row->fallback.has_value()) << key;
                spec += fmt::format("{}{}={}", spec.find(':') == spec.npos ? ':' : ',', key,
                                    *row->fallback);
            }
            EXPECT_EQ(open(spec)->name(), model.name) << part.name;
        }
    }
}

}  // namespace
}  // namespace hshfit::brdfs
