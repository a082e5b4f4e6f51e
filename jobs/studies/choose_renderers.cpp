#include "choose_renderers.h"

#include <hshfit/spelling.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

using Kinds = std::vector<std::string>;

/// Formulas that a shader may evaluate, and coefficients, whose shader is written.
const Kinds shaded{"model", "lobes", "halfway", "coefficients"};
/// Programs that load glTF, and shaders or textures of one's own.
const Kinds engine{"gltf", "halfway", "coefficients"};

const Renderer table[] = {
    {"any",
     "any of them but a measured file, which few read",
     {"model", "lobes", "gltf", "openpbr", "halfway", "coefficients"}},
    {"three", "three.js", engine, "three"},
    {"babylon", "Babylon.js", engine, "babylon"},
    {"playcanvas", "PlayCanvas", engine, "playcanvas"},
    {"filament", "Filament, by gltfio", {"gltf"}},
    {"godot", "Godot 4", engine, "godot"},
    {"unity", "Unity", engine, "unity"},
    {"unreal", "Unreal", engine, "unreal"},
    {"falcor", "Falcor", engine, "falcor"},
    {"blender", "Blender", engine, "blender"},
    {"gltf", "readers of glTF 2.0", {"gltf"}},
    {"openpbr", "renderers with OpenPBR Surface, by MaterialX", {"openpbr"}},
    {"usd", "readers of OpenUSD, with MaterialX or without", {"usd"}},
    {"mitsuba", "Mitsuba 3, by its plugin measured", {"bsdf"}},
    {"pbrt", "pbrt-v4, by its material measured", {"bsdf"}},
    {"glsl", "GLSL 4.50", shaded, "glsl"},
    {"glsl-es", "GLSL ES 3.00", shaded, "glsl-es"},
    {"hlsl", "HLSL", shaded, "hlsl"},
    {"slang", "Slang", shaded, "slang"},
    {"wgsl", "WGSL", shaded, "wgsl"},
    {"metal", "Metal 2", shaded, "metal"},
    {"osl", "OSL 1.10", shaded, "osl"},
};

constexpr CandidateKind fileKinds[] = {
    {"halfway", "the halfway form"},
    {"coefficients", "both directions in a basis, or coefficients per outgoing direction"},
    {"bsdf", "a file of the RGL format", true},
};

}  // namespace

std::span<const CandidateKind> candidateKinds() {
    static const std::vector<CandidateKind> kinds = [] {
        std::vector<CandidateKind> all(formulaKinds().begin(), formulaKinds().end());
        all.insert(all.end(), std::begin(fileKinds), std::end(fileKinds));
        return all;
    }();
    return kinds;
}

void requireKind(std::string_view name) {
    const std::span<const CandidateKind> kinds = candidateKinds();
    if (std::ranges::find(kinds, name, &CandidateKind::name) == kinds.end())
        throw spelling::unknown("kind", name, spelling::namesOf(kinds));
}

std::span<const Renderer> renderers() {
    return table;
}

const Renderer& findRenderer(std::string_view name) {
    const auto row = std::ranges::find(table, name, &Renderer::name);
    if (row != std::end(table)) return *row;
    throw spelling::unknown("renderer", name, spelling::namesOf(renderers()));
}

}  // namespace hshfit::jobs
