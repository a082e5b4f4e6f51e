#pragma once

#include <hshfit/materials/surface.h>

#include <array>
#include <optional>
#include <string>

namespace hshfit::inline materials {

using MaterialColour = std::array<double, 3>;  ///< linear Rec. 709

/// A material of glTF 2.0 by the specification's names, ranges and units; an extension without a
/// value is not written.
struct GltfMaterial {
    struct Specular {
        double factor = 1;
        MaterialColour colour{1, 1, 1};
    };
    struct Sheen {
        MaterialColour colour{0, 0, 0};
        double roughness = 0;
    };
    struct Clearcoat {
        double factor = 0, roughness = 0;
    };
    struct Anisotropy {
        double strength = 0, rotation = 0;  ///< rotation in radians
    };
    std::string name;
    MaterialColour baseColour{1, 1, 1};
    double metallic = 1, roughness = 1;
    std::optional<double> ior;
    std::optional<Specular> specular;
    std::optional<Sheen> sheen;
    std::optional<Clearcoat> clearcoat;
    std::optional<Anisotropy> anisotropy;
};

/// The bytes of a binary glTF 2.0 file (.glb): one scene with one node, whose mesh is `surface`
/// with `material`. `extras`, the text of a JSON object or empty, becomes the material's "extras".
/// Throws NumericError for a number that is not finite, and UsageError for a surface without
/// triangles or above 4 GiB.
std::string glbBytes(const GltfMaterial& material, const Surface& surface,
                     const std::string& extras = {});

}  // namespace hshfit::inline materials
