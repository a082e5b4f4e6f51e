#include <hshfit/irradiance/conventions.h>

#include <hshfit/error.h>
#include <hshfit/files/printable.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view irradiance_three, irradiance_unity, irradiance_unity_csharp,
    irradiance_filament, irradiance_godot, irradiance_unreal, irradiance_babylon, irradiance_gltf,
    irradiance_playcanvas, irradiance_cesium, irradiance_geomerics;
}  // namespace hshfit::embedded

namespace hshfit::inline irradiance {
namespace {

using Rows = std::vector<std::vector<double>>;

/// Share of the largest number below which a number is rounding, and 0 in a shader.
constexpr double rounding = 1e-14;

Rows rowsOf(const NineRgb& nine) {
    Rows rows;
    for (const Rgb& rgb : nine) rows.push_back({rgb[0], rgb[1], rgb[2]});
    return rows;
}

/// E / pi as a polynomial: nine factors of 1, y, z, x, xy, yz, 3 z^2 - 1, xz, x^2 - y^2.
NineRgb polynomial(const NineRgb& radiance) {
    const double one = std::sqrt(1 / (4 * pi)), linear = std::sqrt(3 / (4 * pi));
    const double mixed = std::sqrt(15 / (4 * pi)), zonal = std::sqrt(5 / (16 * pi));
    const double factors[] = {one, linear, linear, linear, mixed, mixed, zonal, mixed, mixed / 2};
    NineRgb result = irradianceOf(radiance);
    for (std::size_t k = 0; k < 9; ++k)
        for (double& value : result[k]) value *= factors[k] / pi;
    return result;
}

Rows packFilament(const NineRgb& radiance) {
    return rowsOf(polynomial(radiance));
}

Rows packRaw(const NineRgb& radiance) {
    return rowsOf(radiance);
}

/// The engine adds what its shader makes of radiance to light that it multiplies with the albedo.
Rows packGodot(const NineRgb& radiance) {
    NineRgb divided = radiance;
    for (Rgb& rgb : divided)
        for (double& value : rgb) value /= pi;
    return rowsOf(divided);
}

/// Seven vectors: by channel (x, y, z, 1), by channel (xy, yz, z^2, zx), then x^2 - y^2.
Rows packSeven(const NineRgb& radiance) {
    const NineRgb p = polynomial(radiance);
    Rows rows;
    for (std::size_t c = 0; c < 3; ++c)
        rows.push_back({p[3][c], p[1][c], p[2][c], p[0][c] - p[6][c]});
    for (std::size_t c = 0; c < 3; ++c) rows.push_back({p[4][c], p[5][c], 3 * p[6][c], p[7][c]});
    rows.push_back({p[8][0], p[8][1], p[8][2], 1});
    return rows;
}

/// Seven vectors, then the average brightness: the mean radiance of the sphere and of R, G, B.
Rows packUnreal(const NineRgb& radiance) {
    Rows rows = packSeven(radiance);
    const Rgb mean = polynomial(radiance)[0];
    rows.push_back({(mean[0] + mean[1] + mean[2]) / 3, 0, 0, 0});
    return rows;
}

/// A row for each channel with the nine factors of the polynomial.
Rows packChannels(const NineRgb& radiance) {
    const NineRgb p = polynomial(radiance);
    Rows rows(3);
    for (const Rgb& rgb : p)
        for (std::size_t c = 0; c < 3; ++c) rows[c].push_back(rgb[c]);
    return rows;
}

/// The polynomial in the order 1, x, y, z, xz, zy, yx, 3 z^2 - 1, x^2 - y^2.
Rows packPlaycanvas(const NineRgb& radiance) {
    const NineRgb p = polynomial(radiance);
    return rowsOf({p[0], p[3], p[1], p[2], p[7], p[5], p[4], p[6], p[8]});
}

/// Irradiance with negative signs of odd m.
Rows packGltf(const NineRgb& radiance) {
    NineRgb e = irradianceOf(radiance);
    for (const std::size_t odd : {1U, 3U, 5U, 7U})
        for (double& value : e[odd]) value = -value;
    return rowsOf(e);
}

Rows packBabylon(const NineRgb& radiance) {
    Rows rows = packGltf(radiance);
    for (auto& row : rows)
        for (double& value : row) value /= pi;
    return rows;
}

/// A row for each channel with the factors of (x, y, z, 1) in bands 0 and 1.
Rows packTwoBands(const NineRgb& radiance) {
    const NineRgb p = polynomial(radiance);
    Rows rows;
    for (std::size_t c = 0; c < 3; ++c) rows.push_back({p[3][c], p[1][c], p[2][c], p[0][c]});
    return rows;
}

Direction upY(const Direction& d) {
    return {d.x, d.z, -d.y};
}
Direction upYLeft(const Direction& d) {
    return {d.x, d.z, d.y};
}
/// The axes of cube maps: +x is to the left of somebody who looks along +z of the scene.
Direction cubeAxes(const Direction& d) {
    return {-d.x, d.z, -d.y};
}
Direction upZLeft(const Direction& d) {
    return {d.x, -d.y, d.z};
}

constexpr std::string_view plus = "all positive (no Condon-Shortley)";
constexpr std::string_view slots = "l(l+1)+m: 00, 1-1, 10, 11, 2-2 … 22";
constexpr std::string_view minus = "negative of odd m (Condon-Shortley)";
constexpr std::string_view panoramic = "middle +x: ToRadialCoords in Skybox-Panoramic.shader";
constexpr std::string_view seven =
    "7 x vec4: R, G, B of (x, y, z, 1); R, G, B of (xy, yz, z^2, zx); RGB of x^2 - y^2";

const Convention table[] = {
    {.name = "three",
     .engine = "three.js LightProbe",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, -y) of ours",
     .handedness = "right",
     .quantity = "raw radiance",
     .divided = "no; the shader gives E, and Lambert's BRDF divides by pi",
     .constants = "no",
     .order = slots,
     .source = "src/math/SphericalHarmonics3.js of npm three 0.187.0",
     .evidence = "run in Node",
     .import = "middle +x: equirectUv in common.glsl.js",
     .toEngine = upY,
     .pack = packRaw,
     .shader = [] { return embedded::irradiance_three; }},
    {.name = "unity",
     .engine = "Unity unity_SHAr … unity_SHC",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, y) of ours",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = seven,
     .source = "SampleSH9 in EntityLighting.hlsl",
     .evidence = "formula only, not run",
     .import = panoramic,
     .toEngine = upYLeft,
     .pack = packSeven,
     .shader = [] { return embedded::irradiance_unity; },
     .hlsl = true},
    {.name = "unity-csharp",
     .engine = "Unity SphericalHarmonicsL2[c, i]",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, y) of ours",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = "by channel l(l+1)+m: [c, 0] … [c, 8]",
     .source = "LightProbeUtility issue 1 (keijiro), unity_SHAr … from [c, i]",
     .evidence = "formula only, not run",
     .import = panoramic,
     .toEngine = upYLeft,
     .pack = packChannels,
     .shader = [] { return embedded::irradiance_unity_csharp; },
     .hlsl = true},
    {.name = "filament",
     .engine = "Filament IndirectLight::Builder::irradiance",
     .signs = "all positive here; its radiance() takes negative signs of odd m",
     .up = "+y; (x, y, z) of the engine = (x, z, -y) of ours",
     .handedness = "right",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = slots,
     .source = "filament/src/details/IndirectLight.cpp at 23b61f519cd8",
     .evidence = "factors of that file; not run",
     .turn = -90,
     .import = "middle +z: equirectangularToCubemap and mirrorCubemap of cmgen",
     .toEngine = upY,
     .pack = packFilament,
     .shader = [] { return embedded::irradiance_filament; }},
    {.name = "godot",
     .engine = "Godot 4 lightmap captures",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, -y) of ours",
     .handedness = "right",
     .quantity = "raw radiance; the shader convolves, and multiplies by IBL_exposure_normalization",
     .divided = "yes: its ambient light is multiplied with the albedo alone",
     .constants = "no",
     .order = slots,
     .source = "scene_forward_clustered.glsl, lightmap_captures",
     .evidence = "factors of that file; not run",
     .turn = -90,
     .import = "middle +z: panorama_coords in sky.glsl",
     .toEngine = upY,
     .pack = packGodot,
     .shader = [] { return embedded::irradiance_godot; }},
    {.name = "unreal",
     .engine = "Unreal SkyIrradianceEnvironmentMap",
     .signs = "all positive here; its FSHVector3 has negative signs of odd m",
     .up = "+z; (x, y, z) of the engine = (x, -y, z) of ours",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = "8 x vec4: the 7 of unity; [7].x is the average brightness",
     .source =
         "GetSkySHDiffuse and GetSkyLightCubemapBrightness in ReflectionEnvironmentShared.ush",
     .evidence = "formula only, not run",
     .turn = 90,
     .import = "middle -y: LookupLongLat in TextureCompressorModule.cpp",
     .toEngine = upZLeft,
     .pack = packUnreal,
     .shader = [] { return embedded::irradiance_unreal; },
     .hlsl = true,
     .redundant = 4},
    {.name = "babylon",
     .engine = "Babylon.js SphericalHarmonics.FromArray",
     .signs = minus,
     .up = "+y; (x, y, z) of the engine = (x, z, y) of ours",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "no",
     .order = slots,
     .source = "sphericalPolynomial.ts at 0d38422b834b: preScaledHarmonics",
     .evidence = "formula of that file, not run",
     .turn = 90,
     .import = "middle +z: panoramaToCubemap.ts and cubemapToSphericalPolynomial.ts",
     .toEngine = upYLeft,
     .pack = packBabylon,
     .shader = [] { return embedded::irradiance_babylon; }},
    {.name = "gltf",
     .engine = "glTF EXT_lights_image_based irradianceCoefficients",
     .signs = minus,
     .up =
         "+y; axes of the cube map: (x, y, z) = (-x, z, -y) of ours; a normal (x, y, z) of glTF is "
         "(-x, y, z) there",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "no",
     .constants = "no",
     .order = slots,
     .source =
         "EXT_lights_image_based.ts of Babylon.js at 00da831dcee8; the text leaves signs open",
     .evidence = "formula of that file, not run",
     .turn = -90,
     .import = "middle +z of the cube map, as Babylon.js makes it",
     .toEngine = cubeAxes,
     .pack = packGltf,
     .shader = [] { return embedded::irradiance_gltf; }},
    {.name = "playcanvas",
     .engine = "PlayCanvas ambientSH",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, -y) of ours",
     .handedness = "right",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = "1, x, y, z, xz, zy, yx, 3 z^2 - 1, x^2 - y^2",
     .source = "lit/frag/ambient.js at 258108ed1502",
     .evidence = "formula of that file, not run",
     .turn = -90,
     .import = "middle +z: toSphericalUv in common/frag/spherical.js",
     .toEngine = upY,
     .pack = packPlaycanvas,
     .shader = [] { return embedded::irradiance_playcanvas; }},
    {.name = "cesium",
     .engine = "CesiumJS ImageBasedLighting.sphericalHarmonicCoefficients",
     .signs = plus,
     .up = "+y of the cube; (x, y, z) = (-x, z, -y) of ours (-east, up, -north)",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = slots,
     .source = "czm_sphericalHarmonics and yUpToZUp of ImageBasedLightingStageFS.glsl",
     .evidence = "formula of that file, not run",
     .turn = -90,
     .import = "middle -north: a cube of cmgen that is not mirrored",
     .toEngine = cubeAxes,
     .pack = packFilament,
     .shader = [] { return embedded::irradiance_cesium; }},
    {.name = "geomerics",
     .engine = "two bands with the reconstruction of Geomerics, in Unity's axes",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, y) of ours",
     .handedness = "left",
     .quantity = "convolved",
     .divided = "yes",
     .constants = "yes",
     .order = "3 x vec4: R, G, B of (x, y, z, 1)",
     .source = "Reconstructing Diffuse Lighting from Spherical Harmonic Data, CEDEC 2015",
     .evidence = "formula only, not run",
     .import = panoramic,
     .toEngine = upYLeft,
     .pack = packTwoBands,
     .shader = [] { return embedded::irradiance_geomerics; },
     .hlsl = true,
     .bands = 2},
};

}  // namespace

std::span<const Convention> conventions() {
    return table;
}

std::vector<const Convention*> selectConventions(std::string_view name) {
    std::vector<const Convention*> chosen;
    for (const Convention& each : table)
        if (name == "all" || name == each.name) chosen.push_back(&each);
    if (chosen.empty())
        throw spelling::unknown("convention", name, spelling::namesOf(table, {"all"}));
    return chosen;
}

std::vector<std::vector<double>> engineValues(const Convention& convention,
                                              const NineRgb& radiance) {
    return convention.pack(inAxes(radiance, convention.toEngine));
}

std::string engineShader(const Convention& convention, const NineRgb& radiance) {
    Rows rows = engineValues(convention, radiance);
    double most = 0;
    for (const auto& row : rows)
        for (const double value : row) most = std::max(most, std::abs(value));
    for (auto& row : rows)
        for (double& value : row)
            if (std::abs(value) < rounding * most) value = 0;
    const bool array = rows.front().size() > 4;
    const std::string open =
        array ? "    {"
              : fmt::format("    {}{}(", convention.hlsl ? "float" : "vec", rows.front().size());
    std::string values;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        values += fmt::format("{}{:.9g}{}{}", open, fmt::join(rows[k], ", "), array ? "}" : ")",
                              k + 1 < rows.size() ? ",\n" : "");
    }
    constexpr std::string_view place = "@VALUES@";
    std::string text(convention.shader());
    text.replace(text.find(place), place.size(), values);
    return printableLines(text);
}

}  // namespace hshfit::inline irradiance
