#include <hshfit/irradiance/conventions.h>

#include <hshfit/error.h>
#include <hshfit/files/printable.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view irradiance_three, irradiance_unity, irradiance_filament,
    irradiance_godot, irradiance_unreal;
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

Direction upY(const Direction& d) {
    return {d.x, d.z, -d.y};
}
Direction upYLeft(const Direction& d) {
    return {d.x, d.z, d.y};
}
Direction upZLeft(const Direction& d) {
    return {d.x, -d.y, d.z};
}

constexpr std::string_view plus = "all positive (no Condon-Shortley)";
constexpr std::string_view slots = "l(l+1)+m: 00, 1-1, 10, 11, 2-2 … 22";
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
     .toEngine = upYLeft,
     .pack = packSeven,
     .shader = [] { return embedded::irradiance_unity; }},
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
     .toEngine = upY,
     .pack = packFilament,
     .shader = [] { return embedded::irradiance_filament; }},
    {.name = "godot",
     .engine = "Godot 4 lightmap captures",
     .signs = plus,
     .up = "+y; (x, y, z) of the engine = (x, z, -y) of ours",
     .handedness = "right",
     .quantity = "raw radiance; the shader convolves",
     .divided = "yes: its ambient light is multiplied with the albedo alone",
     .constants = "no",
     .order = slots,
     .source = "scene_forward_clustered.glsl, lightmap_captures",
     .evidence = "factors of that file; not run",
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
     .order = seven,
     .source = "GetSkySHDiffuse in ReflectionEnvironmentShared.ush",
     .evidence = "formula only, not run",
     .toEngine = upZLeft,
     .pack = packSeven,
     .shader = [] { return embedded::irradiance_unreal; }},
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
    const bool hlsl = rows.front().size() == 4;
    std::string values;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        values +=
            fmt::format("    {}{}({:.9g}", hlsl ? "float" : "vec", rows[k].size(), rows[k].front());
        for (std::size_t c = 1; c < rows[k].size(); ++c)
            values += fmt::format(", {:.9g}", rows[k][c]);
        values += k + 1 < rows.size() ? "),\n" : ")";
    }
    constexpr std::string_view place = "@VALUES@";
    std::string text(convention.shader());
    text.replace(text.find(place), place.size(), values);
    return printableLines(text);
}

}  // namespace hshfit::inline irradiance
