// Files of engines whose world is left-handed, with a BRDF that is not its own mirror image: run on
// Vulkan with stand-ins for what the engine defines, they give its value in a right-handed world.
#include "shaders/runners.h"

#include <hshfit/gpu/engines/engine_files.h>
#include <hshfit/lighting/lighting_shader.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <random>
#include <sstream>

namespace hshfit::shaders {
namespace {

using gpu::Language;

constexpr std::size_t count = 64;

/// f of the test, in C++ and in HLSL.
double formula(const Direction& wo, const Direction& wi) {
    return 1 + 0.5 * wo.x * wi.y - 0.3 * wo.y * wi.x + 0.2 * wi.x + 0.1 * wo.y;
}
constexpr const char* snippet =
    "float hsh_eval(float3 wo, float3 wi) {\n"
    "    return 1.0 + 0.5 * wo.x * wi.y - 0.3 * wo.y * wi.x + 0.2 * wi.x + 0.1 * wo.y;\n}\n";

/// The surfaces, all directions in the engine's world.
struct Surfaces {
    std::vector<Direction> normals, axes, viewers, lights;

    Surfaces() {
        std::mt19937 random(5);
        std::normal_distribution<double> normal;
        const auto direction = [&] {
            const Direction d{normal(random), normal(random), normal(random)};
            const double length = std::sqrt(dot(d, d));
            return Direction{d.x / length, d.y / length, d.z / length};
        };
        while (normals.size() < count) {
            const Direction n = direction(), axis = direction(), v = direction(), l = direction();
            if (dot(n, v) < 0.1 || dot(n, l) < 0.1 || std::abs(dot(n, axis)) > 0.9) continue;
            normals.push_back(n), axes.push_back(axis), viewers.push_back(v), lights.push_back(l);
        }
    }
    std::vector<float> numbers() const {
        std::vector<float> all;
        for (std::size_t k = 0; k < count; ++k)
            for (const auto* of : {&normals, &axes, &viewers, &lights})
                for (const double v : {(*of)[k].x, (*of)[k].y, (*of)[k].z})
                    all.push_back(static_cast<float>(v));
        return all;
    }
};

/// Between a left-handed and a right-handed world.
Direction turned(const Direction& d) {
    return {d.x, d.y, -d.z};
}
Direction crossOf(const Direction& a, const Direction& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Direction unit(const Direction& d) {
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

/// The frame of a surface in the right-handed world.
struct Frame {
    Direction t, b, n;

    Frame(const Direction& normal, const Direction& axis)
        : t(unit(crossOf(turned(axis), turned(normal)))),
          b(crossOf(turned(normal), t)),
          n(turned(normal)) {}
    Direction local(const Direction& d) const {
        const Direction w = turned(d);
        return {dot(w, t), dot(w, b), dot(w, n)};
    }
};

/// f cos(theta_i).
double reflectedAt(const Surfaces& surfaces, std::size_t k) {
    const Frame frame(surfaces.normals[k], surfaces.axes[k]);
    const Direction wo = frame.local(surfaces.viewers[k]), wi = frame.local(surfaces.lights[k]);
    return formula(wo, wi) * wi.z;
}

/// `text` with a compute shader that calls it for every surface.
std::string program(const std::string& text, const std::string& call) {
    return text + R"(
RWStructuredBuffer<float> inputs : register(u3);
RWStructuredBuffer<float> outputs : register(u4);
float3 vectorAt(int k) { return float3(inputs[3 * k], inputs[3 * k + 1], inputs[3 * k + 2]); }
[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {
    int k = int(id.x);
    float3 n = vectorAt(4 * k), a = vectorAt(4 * k + 1);
    float3 v = vectorAt(4 * k + 2), l = vectorAt(4 * k + 3);
    float3 f;
)" + call + R"(
    for (int c = 0; c < 3; ++c) outputs[3 * k + c] = f[c];
}
)";
}

std::vector<float> runSurfaces(const std::string& text, const std::string& call,
                               const Surfaces& surfaces) {
    const std::vector<std::uint32_t> words = toSpirv(Language::hlsl, program(text, call));
    return runHere({.api = Api::vulkan,
                    .program = {reinterpret_cast<const char*>(words.data()), 4 * words.size()},
                    .resources = {{.binding = 3, .numbers = surfaces.numbers()},
                                  {.binding = 4, .count = 3 * count}},
                    .invocations = count,
                    .outputs = 3});
}

std::string textOf(std::string_view suffix, const gpu::EngineMaterial& material) {
    const auto row = std::ranges::find(gpu::engineFiles(), suffix, &gpu::EngineFile::suffix);
    return gpu::engineFile(*row, material);
}

gpu::EngineMaterial material() {
    return {.name = "paint", .title = "grey", .prefix = "hsh", .snippet = snippet};
}

/// Stand-ins for Unity's includes: a light of 2 that is half in shadow, and a probe whose light is
/// 1 + (.3 x, .4 y, .5 z) of the direction at every level.
constexpr const char* unity = R"(
#define UNITY_SHADOW_COORDS(n)
#define UNITY_INITIALIZE_OUTPUT(type, o) o = (type)0
#define UNITY_TRANSFER_SHADOW(o, uv)
#define UNITY_LIGHT_ATTENUATION(share, i, place) float share = 0.5
#define UNITY_PI 3.14159265
#define UNITY_SAMPLE_TEXCUBE_LOD(cube, direction, level) probe(direction, level)
#define unity_SpecCube0_HDR 1.0
float4 probe(float3 d, float level) { return float4(1.0 + float3(0.3, 0.4, 0.5) * d, 1.0); }
float3 DecodeHDR(float4 data, float hdr) { return hdr * data.xyz; }
static float4x4 unity_ObjectToWorld;
static float3 _WorldSpaceCameraPos, lightDirection;
static float4 _LightColor0;
struct appdata_base { float4 vertex; float3 normal; float4 texcoord; };
float4 UnityObjectToClipPos(float4 v) { return v; }
float3 UnityObjectToWorldNormal(float3 n) { return n; }
float3 UnityWorldSpaceLightDir(float3 place) { return lightDirection; }
)";

/// The lookups as a function in place of an array of constants, which the renderer in software
/// takes minutes to compile where it is long.
std::string withoutArray(std::string code) {
    const std::size_t first = code.find("static const float4 hshfit_lookUps"),
                      last = code.find("};", first);
    code.replace(first, last + 2 - first,
                 "float4 lookUpAt(int column) { return column == 0 ? float4(.1, .2, .3, 0.0) : "
                 "column == 1 ? float4(.5, .6, .7, .4) : float4(.36, .48, .8, 0.0); }");
    const std::string place = "hshfit_lookUps[(row) * 3 + (column)]";
    return code.replace(code.find(place), place.size(), "lookUpAt(column)");
}

/// The code of a file .shader for the pass ForwardBase.
std::string unityCode(const std::string& shader) {
    std::istringstream lines(shader.substr(shader.find("CGINCLUDE") + 9));
    std::string code, line;
    const auto take = [&](const char* end) {
        while (std::getline(lines, line) && line.find(end) == line.npos)
            if (line.find("#include") == line.npos && line.find("#pragma") == line.npos)
                code += line + "\n";
    };
    take("ENDCG");
    while (std::getline(lines, line) && line.find("CGPROGRAM") == line.npos) continue;
    take("ENDCG");
    return unity + code;
}

/// Lookups of one lobe that leans out of the plane of incidence, the same for every view.
constexpr std::array<double, 3> diffuse{.1, .2, .3}, lobe{.5, .6, .7}, axis{.36, .48, .8};

void addLookUps(const lighting::AzimuthNodes& azimuths, gpu::EngineMaterial& material) {
    const lighting::LightingShader shader{.kind = lighting::LightingShader::Kind::prefiltered,
                                          .engine = &lighting::prefilterNamed("unity"),
                                          .lobes = 1,
                                          .inPlane = false,
                                          .rows = {.count = 2},
                                          .azimuths = azimuths,
                                          .texels = 3,
                                          .source = "test",
                                          .generator = "test"};
    material.lookUps = lighting::lightingShaderSource(Language::hlsl, shader);
    material.along = azimuths.count > 1;
    material.lookUpWidth = 3;
    material.lookUpHeight = shader.rows.count * azimuths.count;
    for (std::size_t k = 0; k < material.lookUpHeight; ++k)
        for (const auto& [rgb, w] : {std::pair{diffuse, 0.0}, {lobe, 0.4}, {axis, 0.0}})
            for (const double v : {rgb[0], rgb[1], rgb[2], w})
                material.lookUpTexels.push_back(static_cast<float>(v));
}

double probe(const Direction& d, std::size_t c) {
    return 1 + std::array{.3 * d.x, .4 * d.y, .5 * d.z}.at(c);
}

/// The radiance of the lookups. `folded`: lobes of the other sides of the material's axes are
/// mirrored at the plane of incidence.
double lookedUp(const Surfaces& surfaces, std::size_t k, std::size_t c, bool folded) {
    const Frame frame(surfaces.normals[k], surfaces.axes[k]);
    const Direction wo = frame.local(surfaces.viewers[k]);
    const double across = std::hypot(wo.x, wo.y);
    const double side = folded && wo.x * wo.y < 0 ? -1 : 1;
    // Ahead is towards the viewer, aside is normal x ahead.
    const Direction ahead{wo.x / across, wo.y / across, 0}, aside{-ahead.y, ahead.x, 0};
    const double x = axis[0] * ahead.x + side * axis[1] * aside.x,
                 y = axis[0] * ahead.y + side * axis[1] * aside.y, z = axis[2];
    const auto world = [&](double Direction::*at) {
        return x * frame.t.*at + y * frame.b.*at + z * frame.n.*at;
    };
    const Direction leaning =
        turned({world(&Direction::x), world(&Direction::y), world(&Direction::z)});
    return diffuse.at(c) * probe(surfaces.normals[k], c) + lobe.at(c) * probe(leaning, c);
}

void expectNear(const std::vector<float>& found, const Surfaces& surfaces, double factor,
                const std::function<double(std::size_t, std::size_t)>& more = {}) {
    double worst = 0, least = 1e30, most = 0;
    for (std::size_t k = 0; k < count; ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = factor * reflectedAt(surfaces, k) + (more ? more(k, c) : 0);
            const double d = std::abs(static_cast<double>(found[3 * k + c]) - value);
            worst = std::max(worst, d < 1e30 ? d : 1e30);
            least = std::min(least, value), most = std::max(most, value);
        }
    }
    std::cout << fmt::format("{:.1e} of {:.2f} to {:.2f}\n", worst, least, most);
    EXPECT_LE(worst, 2e-5);
}

class EngineWorlds : public testing::Test {
protected:
    const Surfaces surfaces;
};

TEST_F(EngineWorlds, UnrealsNodeIsRightHanded) {
    try {
        expectNear(runSurfaces(textOf("_unreal.ush", material()),
                               "HshfitMaterial m; f = m.reflected(n, a, v, l);", surfaces),
                   surfaces, 1);
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

TEST_F(EngineWorlds, UnitysFunctionForGraphsIsRightHanded) {
    const std::string text = "#define half3 float3\n" + textOf("_graph.hlsl", material());
    try {
        expectNear(runSurfaces(text, "Hshfit_float(n, a, v, l, f);", surfaces), surfaces, pi);
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

/// The shader as its user has it, with lights and the probe; the lookups without a tangent, with
/// one, and with lobes of one quarter.
TEST_F(EngineWorlds, UnitysShaderIsRightHanded) {
    const Laws any{}, symmetric{.mirrorSymmetric = true};
    for (const lighting::AzimuthNodes& azimuths :
         {lighting::AzimuthNodes{}, lighting::AzimuthNodes{any, 1},
          lighting::AzimuthNodes{symmetric, 2}}) {
        gpu::EngineMaterial lit = material();
        addLookUps(azimuths, lit);
        const std::string code = unityCode(textOf(".shader", lit));
        const auto shaded = [&](const std::string& text) {
            return runSurfaces(azimuths.count > 1 ? withoutArray(text) : text,
                               "Corner corner = (Corner)0; corner.normal = n; corner.along = a; "
                               "_WorldSpaceCameraPos = v; lightDirection = l; _LightColor0 = 2.0; "
                               "f = shaded(corner).xyz;",
                               surfaces);
        };
        try {
            const std::vector<float> found = shaded(code);
            expectNear(found, surfaces, pi, [&](std::size_t k, std::size_t c) {
                return lookedUp(surfaces, k, c, azimuths.folded);
            });
            // Lookups in Unity's world itself are mirrored; folded ones do not know the difference.
            const std::vector<float> mirrored =
                shaded(withFault(code, "float3(1.0, 1.0, -1.0)", "float3(1.0, 1.0, 1.0)"));
            double most = 0;
            for (std::size_t i = 0; i < found.size(); ++i)
                most = std::max(most, static_cast<double>(std::abs(found[i] - mirrored[i])));
            EXPECT_EQ(most > 0.1, !azimuths.folded) << most;
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
    }
}

}  // namespace
}  // namespace hshfit::shaders
