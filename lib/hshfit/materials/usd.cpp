#include <hshfit/materials/usd.h>

#include <hshfit/error.h>
#include <hshfit/materials/materialx.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

namespace hshfit::inline materials {
namespace {

/// A string literal.
std::string literal(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
    return result + '"';
}

template <std::size_t count>
void append(std::string& text, const std::array<float, count>& values) {
    text += '(';
    for (std::size_t k = 0; k < count; ++k) {
        if (!std::isfinite(values[k]))
            throw NumericError("a vertex is not finite, which a layer of OpenUSD cannot hold");
        fmt::format_to(std::back_inserter(text), "{}{}", k > 0 ? ", " : "", values[k]);
    }
    text += ')';
}

/// An array of numbers or tuples.
template <class Item>
std::string array(const std::vector<Item>& items) {
    std::string text = "[";
    for (std::size_t k = 0; k < items.size(); ++k) {
        if (k > 0) text += ", ";
        if constexpr (std::is_arithmetic_v<Item>)
            fmt::format_to(std::back_inserter(text), "{}", items[k]);
        else
            append(text, items[k]);
    }
    return text + ']';
}

/// The least and the largest corner of the points.
std::vector<std::array<float, 3>> extentOf(const Surface& surface) {
    std::array<float, 3> least = surface.positions.front(), most = least;
    for (const auto& position : surface.positions) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            least[axis] = std::min(least[axis], position[axis]);
            most[axis] = std::max(most[axis], position[axis]);
        }
    }
    return {least, most};
}

std::string meshText(const std::string& root, const Surface& surface) {
    const std::vector<int> counts(surface.indices.size() / 3, 3);
    return fmt::format(R"(    def Mesh "Surface" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        float3[] extent = {}
        int[] faceVertexCounts = {}
        int[] faceVertexIndices = {}
        rel material:binding = </{}/Material>
        normal3f[] normals = {} (
            interpolation = "vertex"
        )
        uniform token orientation = "rightHanded"
        point3f[] points = {}
        uniform token subdivisionScheme = "none"
    }}
)",
                       array(extentOf(surface)), array(counts), array(surface.indices), root,
                       array(surface.normals), array(surface.positions));
}

/// Every input, so that no reader's own defaults matter.
std::string inputsText(const UsdPreviewSurface& material) {
    const MaterialColour& c = material.diffuseColour;
    const std::pair<const char*, double> numbers[] = {
        {"diffuseColor", c[0]},
        {"diffuseColor", c[1]},
        {"diffuseColor", c[2]},
        {"metallic", material.metallic},
        {"roughness", material.roughness},
        {"ior", material.ior},
        {"clearcoat", material.clearcoat},
        {"clearcoatRoughness", material.clearcoatRoughness}};
    for (const auto& [name, value] : numbers) {
        if (std::isfinite(value)) continue;
        throw NumericError(
            fmt::format("{} is not finite, which a layer of OpenUSD cannot hold", name));
    }
    std::string text =
        fmt::format("            color3f inputs:diffuseColor = ({}, {}, {})\n", c[0], c[1], c[2]);
    for (std::size_t k = 3; k < std::size(numbers); ++k)
        text +=
            fmt::format("            float inputs:{} = {}\n", numbers[k].first, numbers[k].second);
    return text + "            int inputs:useSpecularWorkflow = 0\n";
}

}  // namespace

void requireUsdPath(const std::string& path) {
    const bool fits = std::ranges::none_of(
        path, [](char c) { return c == '@' || static_cast<unsigned char>(c) < 32; });
    if (!fits || path.empty())
        throw UsageError(fmt::format(
            "'{}' cannot be a path in a layer of OpenUSD; expected a name without '@'", path));
}

std::string usdText(std::string_view name, const std::string& materialX,
                    const UsdPreviewSurface& material, const Surface& surface,
                    std::string_view doc) {
    requireUsdPath(materialX);
    if (surface.indices.empty()) throw UsageError("a surface without triangles");
    const std::string root = materialXName(name);
    return fmt::format(R"(#usda 1.0
(
    defaultPrim = "{0}"
    doc = {1}
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "{0}" (
    kind = "component"
)
{{
    def Material "Material" (
        doc = {2}
        prepend references = @./{3}@</MaterialX/Materials/{0}>
    )
    {{
        token outputs:surface.connect = </{0}/Material/PreviewSurface.outputs:surface>

        def Shader "PreviewSurface"
        {{
            uniform token info:id = "UsdPreviewSurface"
{4}            token outputs:surface
        }}
    }}

{5}}}
)",
                       root, literal(fmt::format("hshfit {}", version)), literal(doc), materialX,
                       inputsText(material), meshText(root, surface));
}

}  // namespace hshfit::inline materials
