#include <hshfit/gpu/containers/targets.h>

#include <hshfit/error.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace hshfit::gpu::inline containers {
namespace {

struct Renderer {
    const char *name, *summary;
    std::vector<std::string> parts;
    bool material = false;  ///< a file of gpu/engines comes with the parts
};

/// docs/renderers/ has a page for each.
const Renderer renderers[] = {
    {"babylon", "Babylon.js: a material, and data of one's own", {"bin", "glsl-es", "wgsl"}, true},
    {"playcanvas", "PlayCanvas: a material, and data of one's own", {"bin", "glsl-es"}, true},
    {"filament", "Filament: a material for its compiler", {"glsl-es"}, true},
    {"godot", "Godot 4: a shader, a texture array or a strip", {"dds", "exr", "glsl-es"}, true},
    {"godot3", "Godot 3: a shader", {"glsl-es"}, true},
    {"unity", "Unity: a shader, a function for graphs, data", {"bin", "hlsl"}, true},
    {"unreal", "Unreal: the file of a Custom node, a strip", {"exr", "hlsl"}, true},
    {"falcor", "Falcor: a texture array, a Slang module", {"dds", "slang"}},
    {"blender",
     "Blender: a strip for image nodes, parts for an OSL script",
     {"exr", "exr-parts", "osl"}},
    {"mitsuba", "Mitsuba 3: a tensor file", {"tensor"}},
};

std::vector<Target> makeTargets() {
    std::vector<Target> rows;
    for (const Container& container : containers::catalog()) {
        rows.push_back({Target::Kind::container,
                        std::string(container.name),
                        std::string(container.summary),
                        {}});
    }
    for (const LanguageEntry& language : languages()) {
        rows.push_back(
            {Target::Kind::shader, std::string(language.name), std::string(language.summary), {}});
    }
    rows.push_back({Target::Kind::binary,
                    "spirv",
                    "SPIR-V modules for Vulkan: compute shaders that evaluate, sample and light",
                    {}});
    rows.push_back({Target::Kind::viewer,
                    "viewer",
                    "a page that shows the material: exact, HSH, SH and their difference",
                    {}});
    rows.push_back({Target::Kind::module,
                    "three",
                    "three.js: modules with a material for WebGL and WebGPU, their types, a page",
                    {"bin", "glsl-es"}});
    for (const Renderer& renderer : renderers) {
        const auto kind = renderer.material ? Target::Kind::module : Target::Kind::renderer;
        rows.push_back({kind, renderer.name, renderer.summary, renderer.parts});
    }
    rows.push_back({Target::Kind::material,
                    "gltf",
                    "a .glb: glTF 2.0's material, fitted, on a sphere or a mesh",
                    {}});
    rows.push_back({Target::Kind::material,
                    "materialx",
                    "a .mtlx: open_pbr_surface or gltf_pbr of MaterialX 1.39, fitted",
                    {}});
    rows.push_back({Target::Kind::material,
                    "usd",
                    "a .usda of OpenUSD: UsdPreviewSurface, fitted, and the .mtlx by reference",
                    {"materialx"}});
    rows.push_back({Target::Kind::mips,
                    "mips",
                    "of a map of normals: mips of normal, roughness and anisotropy, BC5 and BC7",
                    {}});
    return rows;
}

const Target& find(std::string_view name) {
    const auto& rows = targets();
    const auto row = std::find_if(rows.begin(), rows.end(),
                                  [&](const Target& target) { return target.name == name; });
    if (row != rows.end()) return *row;
    throw spelling::unknown("target", name, spelling::namesOf(rows, {"all"}));
}

}  // namespace

std::string_view kindName(Target::Kind kind) {
    constexpr std::array<std::string_view, 8> names = {"container", "shader", "viewer", "renderer",
                                                       "material",  "module", "binary", "mips"};
    return names[static_cast<std::size_t>(kind)];
}

const std::vector<Target>& targets() {
    static const std::vector<Target> rows = makeTargets();
    return rows;
}

std::vector<const Target*> selectTargets(std::string_view names) {
    std::vector<const Target*> wanted;
    const auto want = [&](const Target& target) {
        if (target.kind != Target::Kind::renderer) wanted.push_back(&target);
        for (const std::string& part : target.parts) wanted.push_back(&find(part));
    };
    for (std::size_t first = 0; first <= names.size();) {
        const std::size_t last = std::min(names.find(',', first), names.size());
        const std::string_view name = names.substr(first, last - first);
        if (name == "all") {
            for (const Target& target : targets())
                if (target.kind != Target::Kind::material && target.kind != Target::Kind::mips)
                    want(target);
        } else {
            want(find(name));
        }
        first = last + 1;
    }
    std::vector<const Target*> chosen;
    for (const Target& target : targets()) {
        if (std::find(wanted.begin(), wanted.end(), &target) != wanted.end())
            chosen.push_back(&target);
    }
    return chosen;
}

}  // namespace hshfit::gpu::inline containers
