// Shaders of lighting on the renderers in software, at the tests that their export writes, which
// the library computes in double precision.

#include "../binaries/bound_module.h"
#include "../shaders/runners.h"
#include "temporary_folder.h"

#include <jobs/lighting/lighting.h>

#include <hshfit/gpu/vulkan/spirv.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>

namespace hshfit::shaders {
namespace {

using gpu::ComputeResource;
using gpu::Language;
using Json = nlohmann::ordered_json;
using Kind = ComputeResource::Kind;
using Shape = ComputeResource::Shape;

/// A material of the export, with the kind that its shaders are kept under.
struct Material {
    const char *name, *spec;
    bool timed;
};
constexpr Material isotropic{"lighting", "ggx:alpha=.3,F0=.9/.6/.3", true};
constexpr Material brushed{"lighting, brushed", "ggx:ax=.15,ay=.4,F0=.9/.6/.3", false};

std::string fileText(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The files of an export of all models.
struct Exported {
    test::TemporaryFolder folder;
    Json sidecar;

    explicit Exported(const Material& material) {
        jobs::exportLighting(material.spec, folder.path().string(),
                             {.targets = gpu::compilesGlsl() ? "glsl-es,glsl,hlsl,wgsl,spirv"
                                                             : "glsl-es,glsl,hlsl,wgsl",
                              .name = "lit",
                              .measureError = false});
        sidecar = Json::parse(fileText(folder / "lit.lighting.json"));
    }
    bool turned() const { return sidecar["rows"].contains("azimuths"); }
    std::string raw(const Json& entry) const {
        for (const Json& file : entry["files"]) {
            const std::string path = file["path"];
            if (path.ends_with(".bin")) return fileText(folder / path);
        }
        throw std::runtime_error("no raw texels in the sidecar");
    }
    /// The shader in a language or, with the key "bindings", what states those of a module.
    std::string shader(const Json& model, const std::string& target,
                       const char* key = "path") const {
        for (const Json& one : model["shaders"])
            if (one["target"] == target) return fileText(folder / one[key].get<std::string>());
        throw std::runtime_error("no shader in " + target);
    }
};

const Exported& exported(const Material& material) {
    static std::map<std::string, Exported> all;
    return all.try_emplace(material.spec, material).first->second;
}

gpu::Texels texelsOf(const std::string& bytes, int width, int height, std::size_t layers,
                     const std::string& number) {
    gpu::Texels texels;
    texels.width = width;
    texels.height = height;
    texels.layers = layers;
    texels.number = gpu::parseNumber(number);
    const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
    texels.bytes.assign(first, first + bytes.size());
    return texels;
}

/// The table at binding 0 and, of models with one, the cube at binding 1, with their samplers or,
/// where these are apart, the cube's at binding 2.
std::vector<ComputeResource> texturesOf(const Exported& files, const Json& model, bool combined) {
    const Kind kind = combined ? Kind::sampledTexture : Kind::texture;
    const Json& table = model["table"];
    std::vector<ComputeResource> resources{
        {.binding = 0,
         .kind = kind,
         .shape = Shape::flat,
         .texels =
             texelsOf(files.raw(table), table["width"], table["height"], 1, table["number"])}};
    if (!model.contains("cube")) return resources;
    const Json& cube = model["cube"];
    const std::string bytes = files.raw(cube);
    ComputeResource texture{.binding = 1, .kind = kind, .shape = Shape::cube};
    for (const Json& level : cube["levels"]) {
        gpu::Texels texels = texelsOf(bytes.substr(level["offset"], level["bytes"]), level["face"],
                                      level["face"], 6, cube["number"]);
        if (texture.texels.bytes.empty())
            texture.texels = std::move(texels);
        else
            texture.levels.push_back(std::move(texels));
    }
    resources.push_back(std::move(texture));
    if (!combined) resources.push_back({.binding = 2, .kind = Kind::sampler});
    return resources;
}

void append(std::vector<float>& numbers, const Json& vector) {
    for (const Json& value : vector) numbers.push_back(value.get<float>());
}

/// The light as the model's function takes it, in vectors; one at least.
std::vector<float> lightOf(const Json& model) {
    std::vector<float> numbers;
    for (const char* key : {"light", "irradiance"})
        if (model.contains(key))
            for (const Json& rgb : model[key]) append(numbers, rgb);
    if (model.contains("areas")) {
        for (const Json& area : model["areas"]) {
            for (const Json& corner : area["corners"]) append(numbers, corner);
            append(numbers, area["radiance"]);
        }
    }
    if (numbers.empty()) numbers.resize(3);
    return numbers;
}

std::string callOf(const std::string& model, const std::string& surface) {
    if (model == "coefficients") return fmt::format("hsh_coefficients({}, light)", surface);
    if (model == "split-sum") return fmt::format("hsh_splitSum({}, light)", surface);
    if (model == "prefiltered") return fmt::format("hsh_prefiltered({})", surface);
    return fmt::format(
        "lightAt(a + 4) * hsh_ltc({}, lightAt(a), lightAt(a + 1), lightAt(a + 2), lightAt(a + 3))",
        surface);
}

std::string programOf(Language language, const Exported& files, const Json& model,
                      std::size_t lights) {
    const std::map<Language, std::pair<const char*, const char*>> wrappers{
        {Language::glsl, {"glsl", "glsl"}},
        {Language::glslEs, {"glsl_es", "glsl-es"}},
        {Language::hlsl, {"hlsl", "hlsl"}},
        {Language::wgsl, {"wgsl", "wgsl"}}};
    const auto [wrapper, target] = wrappers.at(language);
    kainjow::mustache::data page;
    page.set("snippet", files.shader(model, target));
    page.set("lights", std::to_string(lights));
    page.set("first", std::to_string(3 * files.sidecar["tests"].size()));
    const std::string name = model["model"];
    // The areas of cosines are taken one by one.
    page.set("step", std::to_string(name == "ltc" ? 5 : lights));
    page.set("array", std::to_string(name == "ltc" ? 1 : lights));
    page.set("call", callOf(name, files.turned() ? "n, tangent, wo" : "n, wo"));
    kainjow::mustache::mustache text(fileText(
        fmt::format("{}/tests/gpu/lighting/wrappers/{}.mustache", HSHFIT_SOURCE, wrapper)));
    text.set_custom_escape([](const std::string& s) { return s; });
    return text.render(page);
}

/// Normals, tangents and viewers of the sidecar's tests.
struct Places {
    std::vector<float> normals, tangents, viewers;

    explicit Places(const Json& tests) {
        const Json nothing = {0, 0, 0};
        for (const Json& test : tests) {
            append(normals, test["normal"]);
            append(tangents, test.contains("tangent") ? test["tangent"] : nothing);
            append(viewers, test["viewer"]);
        }
    }
    std::vector<float> inTurns() const {
        std::vector<float> numbers;
        for (std::size_t k = 0; k < normals.size(); k += 3)
            for (const std::vector<float>* of : {&normals, &tangents, &viewers})
                for (std::size_t i = 0; i < 3; ++i) numbers.push_back((*of)[k + i]);
        return numbers;
    }
};

BoundShader shaderOf(Language language, Api api, const Exported& files, const Json& model) {
    const std::vector<float> light = lightOf(model);
    const Json& tests = files.sidecar["tests"];
    const Places places(tests);
    const bool combined = language == Language::glsl || language == Language::glslEs;
    std::string program = programOf(language, files, model, light.size() / 3);
    if (api == Api::vulkan) {
        const std::vector<std::uint32_t> words = toSpirv(language, program);
        program.assign(reinterpret_cast<const char*>(words.data()), 4 * words.size());
    }
    BoundShader shader{.api = api,
                       .program = std::move(program),
                       .resources = texturesOf(files, model, combined),
                       .invocations = tests.size(),
                       .outputs = 3};
    if (api == Api::openGlEs) {
        shader.resources.push_back(vectorTexture(2, 8, 8, 3, places.viewers));
        shader.resources.push_back(vectorTexture(3, 8, 8, 3, places.normals));
        shader.resources.push_back(
            vectorTexture(4, static_cast<int>(light.size() / 3), 1, 3, light));
        shader.resources.push_back(vectorTexture(6, 8, 8, 3, places.tangents));
        return shader;
    }
    std::vector<float> numbers = places.inTurns();
    numbers.insert(numbers.end(), light.begin(), light.end());
    shader.resources.push_back({.binding = 3, .numbers = std::move(numbers)});
    shader.resources.push_back({.binding = 4, .count = 3 * tests.size()});
    return shader;
}

/// The surfaces' place in the world, from which they see the corners.
constexpr std::array<float, 3> surfacePlace{2.5F, -1.25F, 0.5F};

/// Normals, tangents and viewers by turns, and the place where the module reads one: a vector of
/// four each.
std::vector<float> surfaceItems(const Json& stated, const Places& places) {
    std::vector<float> numbers;
    for (std::size_t k = 0; k < places.normals.size(); k += 3) {
        for (const Json& field : stated["fields"]) {
            const std::string name = field["name"];
            for (std::size_t i = 0; i < 3; ++i)
                numbers.push_back(name == "normal"    ? places.normals[k + i]
                                  : name == "tangent" ? places.tangents[k + i]
                                  : name == "viewer"  ? places.viewers[k + i]
                                                      : surfacePlace.at(i));
            numbers.push_back(-7);
        }
    }
    return numbers;
}

/// The module that was written, bound as the file beside it states.
BoundShader moduleOf(const Exported& files, const Json& model) {
    const std::string bytes = files.shader(model, "spirv");
    const std::string text = files.shader(model, "spirv", "bindings");
    std::vector<std::uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), bytes.size());
    validateSpirv(words);
    EXPECT_EQ(listedBindings(disassembled(words)), statedBindings(text));
    std::vector<ComputeResource> bound = texturesOf(files, model, true);
    std::vector<float> items;
    const Json document = Json::parse(text);
    for (const Json& stated : document["bindings"]) {
        if (stated["binding"] == 2) items = surfaceItems(stated, Places(files.sidecar["tests"]));
        if (stated["binding"] != 4) continue;
        const std::vector<float> given = lightOf(model);
        std::vector<float> light;
        for (std::size_t i = 0; i < given.size(); ++i) {
            const Json& field = stated["fields"][i / 3 % stated["fields"].size()];
            const bool corner = field["name"].get<std::string>().starts_with("corner");
            light.push_back(given[i] + (corner ? surfacePlace.at(i % 3) : 0));
            if (i % 3 == 2) light.push_back(-7);
        }
        bound.push_back({.binding = 4, .numbers = std::move(light)});
    }
    return boundModule(words, std::move(items), files.sidecar["tests"].size(), 3, std::move(bound));
}

/// Relative to the largest radiance.
Wanted wantedOf(const Exported& files, const std::string& model) {
    Wanted wanted;
    double most = 0;
    for (const Json& test : files.sidecar["tests"]) {
        for (const Json& value : test[model]) {
            wanted.values.push_back(value);
            most = std::max(most, std::abs(wanted.values.back()));
        }
    }
    wanted.scales.assign(wanted.values.size(), most);
    return wanted;
}

/// Cube maps are float16, of 11 bits, and a GPU filters them with weights of 8 bits.
Bounds boundsOf(const Json& model) {
    if (model.contains("cube")) return {5e-4, 1e-2};
    return {2e-5, 2e-5};
}

/// Keeps the function to be timed on other machines.
void keepForTimes(int place, const Exported& files, const Json& model) {
    const std::string name = model["model"];
    std::vector<float> light;
    for (const float value : lightOf(model)) {
        light.push_back(value);
        if (light.size() % 4 == 3) light.push_back(0);
    }
    const std::size_t count = name == "ltc" ? 4 : light.size() / 4;
    light.resize(4 * count);
    std::vector<ComputeResource> resources = texturesOf(files, model, true);
    resources.push_back({.binding = 6, .kind = Kind::uniforms, .numbers = std::move(light)});
    const std::string call = name == "ltc"
                                 ? "hsh_ltc(n, viewer, light[0], light[1], light[2], light[3])"
                                 : callOf(name, "n, viewer");
    keepTimed({.place = place,
               .name = fmt::format("lighting `{}`", name),
               .snippet = files.shader(model, "glsl") +
                          fmt::format("\nlayout(std140, binding = 6) uniform Light {{ vec4 "
                                      "lights[{}]; }};\n",
                                      count),
               .before = fmt::format("vec3 light[{0}];\n    for (int i = 0; i < {0}; ++i) "
                                     "light[i] = lights[i].xyz;",
                                     count),
               .call = call},
              std::move(resources));
}

void prove(const Material& material, Language language, Api api) {
    const Exported& files = exported(material);
    int place = 30;
    for (const Json& model : files.sidecar["models"]) {
        const std::string name = model["model"];
        const Wanted wanted = wantedOf(files, name);
        const Bounds bounds = boundsOf(model);
        try {
            const double difference =
                largestDifference(wanted, runHere(shaderOf(language, api, files, model)));
            std::cout << fmt::format("{:<14} {:.1e}\n", name, difference);
            EXPECT_LE(difference, bounds.here()) << name;
            keepLast(material.name, language, name, wanted, bounds);
            if (material.timed && language == Language::glsl && api == Api::vulkan)
                keepForTimes(place++, files, model);
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << name << ": " << reason.what();
        }
    }
}

void proveModules(const Material& material) {
    if (!gpu::compilesGlsl()) GTEST_SKIP() << "built without Vulkan (libvulkan-dev)";
    const Exported& files = exported(material);
    for (const Json& model : files.sidecar["models"]) {
        const std::string name = model["model"];
        const Wanted wanted = wantedOf(files, name);
        const Bounds bounds = boundsOf(model);
        try {
            const double difference = largestDifference(wanted, runHere(moduleOf(files, model)));
            std::cout << fmt::format("{:<14} {:.1e}\n", name, difference);
            EXPECT_LE(difference, bounds.here()) << name;
            keepLast(std::string(material.name) + ", modules", Language::glsl, name, wanted,
                     bounds);
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
    }
}

TEST(LightingShader, SpirvModulesOnVulkan) {
    proveModules(isotropic);
}
TEST(BrushedLightingShader, SpirvModulesOnVulkan) {
    proveModules(brushed);
}
TEST(LightingShader, GlslOnVulkan) {
    prove(isotropic, Language::glsl, Api::vulkan);
}
TEST(LightingShader, HlslOnVulkan) {
    prove(isotropic, Language::hlsl, Api::vulkan);
}
TEST(LightingShader, WgslOnVulkan) {
    prove(isotropic, Language::wgsl, Api::vulkan);
}
TEST(LightingShader, GlslOnOpenGl) {
    prove(isotropic, Language::glsl, Api::openGl);
}
TEST(LightingShader, GlslEsOnOpenGlEs) {
    prove(isotropic, Language::glslEs, Api::openGlEs);
}
TEST(BrushedLightingShader, GlslOnVulkan) {
    prove(brushed, Language::glsl, Api::vulkan);
}
TEST(BrushedLightingShader, HlslOnVulkan) {
    prove(brushed, Language::hlsl, Api::vulkan);
}
TEST(BrushedLightingShader, WgslOnVulkan) {
    prove(brushed, Language::wgsl, Api::vulkan);
}
TEST(BrushedLightingShader, GlslOnOpenGl) {
    prove(brushed, Language::glsl, Api::openGl);
}
TEST(BrushedLightingShader, GlslEsOnOpenGlEs) {
    prove(brushed, Language::glslEs, Api::openGlEs);
}

/// A shader with a fault gives something else: the tests can fail.
TEST(LightingShader, FaultsShow) {
    const Exported& files = exported(isotropic);
    struct Fault {
        const char *model, *right, *wrong;
    };
    const Fault faults[] = {{"coefficients", "return a + (u - below)", "return a + (below - u)"},
                            {"split-sum", "0.31830989 * even", "0.3 * even"},
                            {"ltc", "above[next]", "above[k]"},
                            {"prefiltered", " * n - sin(", " * n + sin("}};
    std::size_t tried = 0;
    for (const Fault& fault : faults) {
        for (const Json& model : files.sidecar["models"]) {
            if (model["model"] != fault.model) continue;
            ++tried;
            try {
                BoundShader shader = shaderOf(Language::glsl, Api::openGl, files, model);
                shader.program = withFault(shader.program, fault.right, fault.wrong);
                EXPECT_GT(largestDifference(wantedOf(files, fault.model), runHere(shader)),
                          2 * boundsOf(model).here())
                    << fault.model;
            } catch (const Missing& reason) {
                GTEST_SKIP() << reason.what();
            }
        }
    }
    EXPECT_EQ(tried, std::size(faults));
}

}  // namespace
}  // namespace hshfit::shaders
