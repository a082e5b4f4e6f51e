// Irradiance against closed forms, and the numbers of each engine put into that engine's own
// formula.

#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/irradiance/conventions.h>
#include <hshfit/irradiance/direct_irradiance.h>
#include <hshfit/irradiance/geomerics.h>
#include <hshfit/irradiance/irradiance.h>
#include <hshfit/irradiance/zonal_form.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/transfer/convolution.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

using namespace hshfit;

namespace {

NineRgb randomNine(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    NineRgb nine;
    for (Rgb& rgb : nine)
        for (double& value : rgb) value = normal(random);
    return nine;
}

NineRgb nineOfLights(const std::vector<Light>& lights) {
    const LightCoefficients light = projectLight(lights, *bases::makeSh(3, {}));
    NineRgb nine;
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c) nine[k][c] = light.at(c)[k];
    return nine;
}

PictureLight randomPicture(std::size_t height, PictureLayout layout = PictureLayout::latlong) {
    std::mt19937_64 random(height);
    std::uniform_real_distribution<float> value(0, 2);
    const std::size_t width = layout == PictureLayout::latlong ? 2 * height : height;
    PictureLight picture{.file = "", .width = width, .height = height, .rgb = {}, .layout = layout};
    for (std::size_t k = 0; k < 3 * width * height; ++k) picture.rgb.push_back(value(random));
    return picture;
}

TEST(Irradiance, UniformLightGivesPiEverywhere) {
    std::vector<Light> all{SkyLight{.zenith = {1, 1, 1}, .ground = {1, 1, 1}}};
    for (const std::size_t height : {2, 8, 64, 600}) {
        PictureLight white = randomPicture(height);
        std::fill(white.rgb.begin(), white.rgb.end(), 1.0F);
        all.emplace_back(std::move(white));
    }
    for (const Light& light : all) {
        const NineRgb irradiance = irradianceOf(nineOfLights({light}));
        const std::vector<Light> lights{light};
        const DirectIrradiance direct(lights);
        for (const Direction& normal : normalLattice(50)) {
            for (const double value : evaluateNine(irradiance, normal))
                EXPECT_NEAR(value, pi, 1e-12);
            // Pixels on the horizon count with their centres.
            for (const double value : direct.at(normal)) EXPECT_NEAR(value, pi, 3e-5);
        }
    }
}

TEST(Irradiance, DiscsAboveTheHorizonAreClosedForms) {
    const double radius = 0.4;
    const Direction towards = directionFromAngles(0.8, -1.9);
    const std::vector<Light> lights{DiscLight{towards, radius, {1, 2, 3}}};
    const DirectIrradiance direct(lights);
    for (const Direction& normal : normalLattice(300)) {
        const double cosine = dot(normal, towards), angle = std::acos(cosine);
        if (std::abs(angle - pi / 2) < radius) continue;
        const double expected = angle > pi / 2 ? 0 : pi * std::pow(std::sin(radius), 2) * cosine;
        const Rgb value = direct.at(normal);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(value[c], static_cast<double>(c + 1) * expected, 1e-12);
    }
}

TEST(Irradiance, NineOfParallelLightAreTheSeriesOfTheClampedCosine) {
    // Bands 0 to 2 of max(0, cos): 1/4 + cos/2 + (5/32)(3 cos^2 - 1), Ramamoorthi & Hanrahan 2001.
    const Direction towards = directionFromAngles(1.1, 0.3);
    const NineRgb irradiance = irradianceOf(nineOfLights({DirectionalLight{towards, {4, 2, 1}}}));
    for (const Direction& normal : normalLattice(100)) {
        const double cosine = dot(normal, towards);
        const double expected = 0.25 + cosine / 2 + 5.0 / 32 * (3 * cosine * cosine - 1);
        const Rgb value = evaluateNine(irradiance, normal);
        EXPECT_NEAR(value[0], 4 * expected, 1e-14);
        EXPECT_NEAR(value[2], expected, 1e-14);
    }
}

TEST(Irradiance, DirectIntegrationOfPicturesIsTheSeriesToHighOrder) {
    const std::vector<Light> lights{randomPicture(96)};
    const DirectIrradiance direct(lights);
    LightCoefficients light = projectLight(lights, *bases::makeSh(60, {}));
    for (std::size_t c = 0; c < 3; ++c) convolve({light.at(c), light.slots()}, clampedCosine(60));
    const auto harmonics = bases::makeSh(60, {});
    for (const Direction& normal : normalLattice(60)) {
        std::vector<double> values(light.slots());
        harmonics->evaluate(normal, values.data());
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t k = 0; k < values.size(); ++k) sum += light.at(c)[k] * values[k];
            EXPECT_NEAR(direct.at(normal)[c], sum, 1e-3 * pi);
        }
    }
}

TEST(Irradiance, OtherLayoutsOfAPictureAreIntegratedTheSame) {
    const PictureLight picture = randomPicture(90, PictureLayout::angular);
    const std::vector<Light> lights{picture};
    const DirectIrradiance direct(lights);
    const NineRgb nine = irradianceOf(nineOfLights(lights));
    double sum = 0, expected = 0;
    for (const Direction& normal : normalLattice(500)) {
        sum += direct.at(normal)[1] / 500;
        expected += evaluateNine(nine, normal)[1] / 500;
    }
    EXPECT_NEAR(sum / expected, 1, 1e-3);
}

TEST(Irradiance, CoefficientsInOtherAxesAreTheSameFunction) {
    const NineRgb nine = randomNine(1);
    for (const Convention& convention : conventions()) {
        const NineRgb turned = inAxes(nine, convention.toEngine);
        for (const Direction& d : normalLattice(40)) {
            const Rgb a = evaluateNine(nine, d), b = evaluateNine(turned, convention.toEngine(d));
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-13);
        }
    }
}

using Rows = std::vector<std::vector<double>>;

/// Filament's shader, and its factors of radiance with signs (IndirectLight.cpp).
double filament(const Rows& sh, std::size_t c, const Direction& n) {
    return sh[0][c] + sh[1][c] * n.y + sh[2][c] * n.z + sh[3][c] * n.x + sh[4][c] * n.y * n.x +
           sh[5][c] * n.y * n.z + sh[6][c] * (3 * n.z * n.z - 1) + sh[7][c] * n.z * n.x +
           sh[8][c] * (n.x * n.x - n.y * n.y);
}

/// SampleSH9 of Unity and GetSkySHDiffuse of Unreal.
double seven(const Rows& sh, std::size_t c, const Direction& n) {
    const auto& a = sh[c];
    const auto& b = sh[3 + c];
    return a[0] * n.x + a[1] * n.y + a[2] * n.z + a[3] + b[0] * n.x * n.y + b[1] * n.y * n.z +
           b[2] * n.z * n.z + b[3] * n.z * n.x + sh[6][c] * (n.x * n.x - n.y * n.y);
}

/// Ramamoorthi & Hanrahan 2001, Eq. 13, as in Godot and three.js.
double ramamoorthi(const Rows& sh, std::size_t c, const Direction& n) {
    const double c1 = 0.429043, c2 = 0.511664, c3 = 0.743125, c4 = 0.886227, c5 = 0.247708;
    return c1 * sh[8][c] * (n.x * n.x - n.y * n.y) + c3 * sh[6][c] * n.z * n.z + c4 * sh[0][c] -
           c5 * sh[6][c] +
           2 * c1 * (sh[4][c] * n.x * n.y + sh[7][c] * n.x * n.z + sh[5][c] * n.y * n.z) +
           2 * c2 * (sh[3][c] * n.x + sh[1][c] * n.y + sh[2][c] * n.z);
}

/// SphericalHarmonicsL2.Evaluate by channel: filament's polynomial.
double channels(const Rows& sh, std::size_t c, const Direction& n) {
    Rows nine;
    for (const double value : sh[c]) nine.push_back({value});
    return filament(nine, 0, n);
}

/// PlayCanvas' addAmbient.
double playcanvas(const Rows& sh, std::size_t c, const Direction& n) {
    return sh[0][c] + sh[1][c] * n.x + sh[2][c] * n.y + sh[3][c] * n.z + sh[4][c] * n.x * n.z +
           sh[5][c] * n.z * n.y + sh[6][c] * n.y * n.x + sh[7][c] * (3 * n.z * n.z - 1) +
           sh[8][c] * (n.x * n.x - n.y * n.y);
}

/// preScaleForRendering of Babylon.js, whose constants have signs, and
/// computeEnvironmentIrradiance.
double babylon(const Rows& sh, std::size_t c, const Direction& n) {
    const double one = std::sqrt(3 / (4 * pi)), two = std::sqrt(15 / (4 * pi));
    const double constants[] = {std::sqrt(1 / (4 * pi)),  -one, one,    -one, two, -two,
                                std::sqrt(5 / (16 * pi)), -two, two / 2};
    Rows scaled;
    for (std::size_t k = 0; k < 9; ++k) scaled.push_back({sh[k][c] * constants[k]});
    return filament(scaled, 0, n);
}

/// shEvaluateDiffuseL1Geomerics as shaders print it, of (x, y, z, 1).
double geomerics(const Rows& sh, std::size_t c, const Direction& n) {
    const double r0 = sh[c][3], x = sh[c][0] / 2, y = sh[c][1] / 2, z = sh[c][2] / 2;
    const double size = std::sqrt(x * x + y * y + z * z);
    const double q = (x * n.x + y * n.y + z * n.z) / size / 2 + 0.5, p = 1 + 2 * size / r0;
    const double a = (1 - size / r0) / (1 + size / r0);
    return r0 * (a + (1 - a) * (p + 1) * std::pow(q, p));
}

struct Formula {
    double (*value)(const Rows&, std::size_t, const Direction&);
    double divisor, tolerance;
};

const std::map<std::string_view, Formula>& formulas() {
    static const std::map<std::string_view, Formula> all{
        {"three", {ramamoorthi, 1, 1e-5}},    {"unity", {seven, pi, 1e-13}},
        {"filament", {filament, pi, 1e-13}},  {"godot", {ramamoorthi, pi, 1e-5}},
        {"unreal", {seven, pi, 1e-13}},       {"unity-csharp", {channels, pi, 1e-13}},
        {"babylon", {babylon, pi, 1e-13}},    {"gltf", {babylon, 1, 1e-13}},
        {"cesium", {filament, pi, 1e-13}},    {"playcanvas", {playcanvas, pi, 1e-13}},
        {"geomerics", {geomerics, pi, 1e-13}}};
    return all;
}

/// The coefficients with a constant that leaves no channel negative.
NineRgb brightNine(std::uint64_t seed) {
    NineRgb nine = randomNine(seed);
    for (double& value : nine[0]) value = 20 + value;
    return nine;
}

Rgb expectedAt(const Convention& convention, const NineRgb& radiance, const Direction& normal) {
    return convention.bands == 2 ? geomericsIrradiance(radiance, normal)
                                 : evaluateNine(irradianceOf(radiance), normal);
}

TEST(Irradiance, NumbersOfEveryEngineGiveItsIrradianceInItsFormula) {
    const NineRgb radiance = brightNine(2);
    for (const Convention& convention : conventions()) {
        const Formula& formula = formulas().at(convention.name);
        const Rows rows = engineValues(convention, radiance);
        for (const Direction& normal : normalLattice(100)) {
            const Rgb expected = expectedAt(convention, radiance, normal);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(formula.value(rows, c, convention.toEngine(normal)),
                            expected[c] / formula.divisor, 20 * formula.tolerance)
                    << convention.name;
        }
    }
    EXPECT_EQ(conventions().size(), formulas().size());
}

TEST(Irradiance, TheEighthVectorOfUnrealIsTheMeanRadiance) {
    const Rows rows =
        engineValues(*selectConventions("unreal").front(),
                     nineOfLights({SkyLight{.zenith = {1, 2, 6}, .ground = {1, 2, 6}}}));
    ASSERT_EQ(rows.size(), 8U);
    EXPECT_NEAR(rows[7][0], 3, 1e-12);
}

TEST(Irradiance, GeomericsKeepsTheMeanAndIsExactInItsLimits) {
    const NineRgb nine = brightNine(8);
    Rgb mean{};
    const std::size_t count = 20000;
    for (const Direction& normal : normalLattice(count))
        for (std::size_t c = 0; c < 3; ++c)
            mean[c] += geomericsIrradiance(nine, normal)[c] / static_cast<double>(count);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c], pi * nine[0][c] / std::sqrt(4 * pi), 1e-6 * mean[c]);
    // Parallel light: E / pi is 4 r0 q^3 with r0 = irradiance / (4 pi); uniform light: pi L.
    const Direction towards = directionFromAngles(1.1, 0.3);
    const NineRgb parallel = nineOfLights({DirectionalLight{towards, {4, 4, 4}}});
    for (const Direction& normal : normalLattice(50))
        EXPECT_NEAR(geomericsIrradiance(parallel, normal)[0],
                    4 * std::pow((1 + dot(towards, normal)) / 2, 3), 1e-6);
    NineRgb uniform{};
    uniform[0].fill(std::sqrt(4 * pi));
    EXPECT_NEAR(geomericsIrradiance(uniform, towards)[2], pi, 1e-12);
}

// --- imports of panoramas: ports of the engines' lookups, a direction to (u, v), v from the top --

struct Place {
    double u, v;
};

Place turns(double y, double x, double up) {
    return {std::atan2(y, x) / (2 * pi) + 0.5, 0.5 - std::asin(std::clamp(up, -1.0, 1.0)) / pi};
}

/// panoramaToCubemap.ts fills faces of corners, cubemapToSphericalPolynomial.ts reads them by axes.
Place babylonImport(const Direction& d) {
    struct Face {
        Direction normal, x, y;
        Direction corners[4];
    };
    static const Face faces[] = {
        {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}, {{1, -1, 1}, {-1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}},
        {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}}},
        {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {{-1, -1, -1}, {-1, -1, 1}, {1, -1, -1}, {1, -1, 1}}},
        {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}, {{1, 1, -1}, {1, 1, 1}, {-1, 1, -1}, {-1, 1, 1}}},
        {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {{1, -1, -1}, {1, -1, 1}, {1, 1, -1}, {1, 1, 1}}},
        {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}, {{-1, -1, 1}, {-1, -1, -1}, {-1, 1, 1}, {-1, 1, -1}}}};
    const Face* face = faces;
    for (const Face& each : faces)
        if (dot(d, each.normal) > dot(d, face->normal)) face = &each;
    const double depth = dot(d, face->normal), s = (1 + dot(d, face->x) / depth) / 2,
                 t = (1 + dot(d, face->y) / depth) / 2;
    const double weights[] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    Direction v{0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) {
        v.x += weights[k] * face->corners[k].x;
        v.y += weights[k] * face->corners[k].y;
        v.z += weights[k] * face->corners[k].z;
    }
    const double size = std::sqrt(dot(v, v));
    return {std::atan2(v.z, v.x) / (2 * pi) + 0.5, 1 - std::acos(v.y / size) / pi};
}

using Import = Place (*)(const Direction&);

const std::map<std::string_view, Import>& imports() {
    static const Import panoramic = [](const Direction& d) {
        return Place{0.5 - std::atan2(d.z, d.x) / (2 * pi), std::acos(d.y) / pi};
    };
    static const Import mirrored = [](const Direction& d) { return turns(-d.x, d.z, d.y); };
    static const std::map<std::string_view, Import> all{
        {"three", [](const Direction& d) { return turns(d.z, d.x, d.y); }},
        {"unity", panoramic},
        {"unity-csharp", panoramic},
        {"geomerics", panoramic},
        {"filament", mirrored},
        {"playcanvas", mirrored},
        {"cesium", [](const Direction& d) { return turns(d.x, d.z, d.y); }},
        {"godot",
         [](const Direction& d) {
             const double u = std::atan2(d.x, -d.z);
             return Place{(u < 0 ? u + 2 * pi : u) / (2 * pi), std::acos(d.y) / pi};
         }},
        // The faces of the cube exchange y and z before LookupLongLat.
        {"unreal", [](const Direction& d) { return turns(d.x, -d.y, d.z); }},
        {"babylon", babylonImport},
        {"gltf", babylonImport}};
    return all;
}

/// The nine coefficients of radiance in an engine's axes, of a panorama that it imports.
NineRgb imported(const NineRgb& panorama, Import import) {
    NineRgb sum{};
    const std::size_t rings = 6, azimuths = 12;
    const std::size_t count = rings * azimuths;
    const double nodes[] = {0.2386191860831969, 0.6612093864662645, 0.9324695142031521};
    const double weights[] = {0.4679139345726910, 0.3607615730481386, 0.1713244923791704};
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t ring = k / azimuths;
        const double z = (ring < 3 ? 1 : -1) * nodes[ring % 3];
        const Direction d = directionFromAngles(
            std::acos(z), 2 * pi * (static_cast<double>(k % azimuths) + 0.37) / azimuths);
        const Place at = import(d);
        const Rgb value =
            evaluateNine(panorama, directionFromAngles(pi * at.v, pi - 2 * pi * at.u));
        const double weight = weights[ring % 3] * 2 * pi / azimuths;
        for (std::size_t slot = 0; slot < 9; ++slot) {
            NineRgb unit{};
            unit[slot].fill(1);
            const double function = evaluateNine(unit, d)[0];
            for (std::size_t c = 0; c < 3; ++c) sum[slot][c] += weight * value[c] * function;
        }
    }
    return sum;
}

TEST(Irradiance, TurnedNumbersAreThoseOfTheEnginesImportOfThePanorama) {
    const NineRgb panorama = brightNine(9);
    for (const Convention& convention : conventions()) {
        const NineRgb theirs = imported(panorama, imports().at(convention.name));
        const NineRgb ours = inAxes(panorama, [&](const Direction& d) {
            const double a = radians(convention.turn);
            return Direction{d.x * std::cos(a) - d.y * std::sin(a),
                             d.x * std::sin(a) + d.y * std::cos(a), d.z};
        });
        const Formula& formula = formulas().at(convention.name);
        const Rows rows = engineValues(convention, ours);
        for (const Direction& n : normalLattice(40)) {
            const Rgb expected = expectedAt(convention, theirs, n);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(formula.value(rows, c, n), expected[c] / formula.divisor,
                            40 * formula.tolerance)
                    << convention.name;
        }
    }
}

/// Cesium's yUpToZUp times a direction of its east, north, up frame gives the axes of its numbers.
TEST(Irradiance, CesiumsAxesAreItsMatrixTimesEastNorthUp) {
    const auto& row = *selectConventions("cesium").front();
    for (const Direction& v : normalLattice(20)) {
        const Direction cube{-v.x, v.z, -v.y};
        EXPECT_NEAR(dot(cube, row.toEngine(v)), 1, 1e-14);
    }
}

TEST(Irradiance, FilamentsNumbersAreItsFactorsTimesRadiance) {
    // The magnitudes that IndirectLight.cpp asserts.
    const double factors[] = {0.282095, 0.325735, 0.325735, 0.325735, 0.273137,
                              0.273137, 0.078848, 0.273137, 0.136569};
    const NineRgb radiance = randomNine(3);
    const Convention& row = *selectConventions("filament").front();
    const NineRgb engine = inAxes(radiance, row.toEngine);
    const Rows rows = engineValues(row, radiance);
    for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(rows[k][0], factors[k] * engine[k][0], 1e-6 * std::abs(engine[k][0]));
}

TEST(Irradiance, ShadersHoldTheNumbers) {
    const NineRgb radiance = randomNine(4);
    for (const Convention& convention : conventions()) {
        const std::string text = engineShader(convention, radiance);
        EXPECT_EQ(text.find('@'), std::string::npos);
        EXPECT_NE(text.find(std::to_string(engineValues(convention, radiance)[0][0]).substr(0, 6)),
                  std::string::npos)
            << text;
    }
    EXPECT_THROW(selectConventions("quake"), UsageError);
}

TEST(Irradiance, ZonalFormKeepsLightThatIsZonalAboutItsAxis) {
    const NineRgb nine = nineOfLights({DiscLight{directionFromAngles(0.9, 2), 0.5, {1, 2, 3}}});
    const NineRgb kept = nineOf(zonalForm(nine));
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(kept[k][c], nine[k][c], 1e-14);
}

TEST(Irradiance, ZonalFormIsTheLeastSquaresPartAboutItsAxis) {
    const NineRgb nine = randomNine(5);
    ZonalForm form = zonalForm(nine);
    const auto distance = [&] {
        const NineRgb other = nineOf(form);
        double sum = 0;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t c = 0; c < 3; ++c) sum += std::pow(other[k][c] - nine[k][c], 2);
        return sum;
    };
    const double least = distance();
    for (const double step : {-0.01, 0.01}) {
        for (double& value : form.quadratic) value += step;
        EXPECT_GT(distance(), least);
        for (double& value : form.quadratic) value -= step;
    }
}

TEST(Irradiance, ErrorsAreRelativeToTheMeanIrradiance) {
    const std::vector<Direction> normals = normalLattice(4);
    const Irradiances direct(4, Rgb{2, 2, 2});
    Irradiances other = direct;
    other[2] = {2, -1, 2};
    const IrradianceErrors errors = errorsOf(normals, direct, other);
    EXPECT_DOUBLE_EQ(errors.maximum, 1.5);
    EXPECT_DOUBLE_EQ(errors.mean, 1.5 / 12);
    EXPECT_DOUBLE_EQ(errors.negative, -0.5);
    EXPECT_EQ(errors.worst.z, normals[2].z);
}

}  // namespace
