#pragma once

#include <hshfit/materials/glb.h>
#include <hshfit/materials/surface.h>

#include <string>
#include <string_view>

namespace hshfit::inline materials {

/// Inputs of UsdPreviewSurface (specification 2.5, openusd.org) in its metalness workflow, as far
/// as an opaque, even surface has them. Colours are linear Rec. 709; `ior` is the index of the base
/// and of the coat.
struct UsdPreviewSurface {
    MaterialColour diffuseColour{0.18, 0.18, 0.18};
    double metallic = 0, roughness = 0.5, ior = 1.5;
    double clearcoat = 0, clearcoatRoughness = 0.01;
};

/// A layer of OpenUSD as text (.usda), +y up, in metres: `surface` as a mesh with one material. The
/// material has UsdPreviewSurface for every renderer, and by a reference MaterialX for those that
/// read it: the surfacematerial of `name` in the file `materialX`, a path relative to the layer, at
/// the place that OpenUSD's reader of MaterialX (UsdMtlx) gives it. `doc` is the material's
/// description.
/// Throws UsageError for a surface without triangles, NumericError for a number that is not finite,
/// and as requireUsdPath does.
std::string usdText(std::string_view name, const std::string& materialX,
                    const UsdPreviewSurface& material, const Surface& surface,
                    std::string_view doc);

/// Throws UsageError for a path that a layer cannot name, with '@' or control characters.
void requireUsdPath(const std::string& path);

}  // namespace hshfit::inline materials
