#pragma once

#include <hshfit/materials/surface.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
    struct Iridescence {
        double factor = 0, ior = 1.3, thickness = 400;  ///< of the film; thickness in nm
    };
    std::string name;
    MaterialColour baseColour{1, 1, 1};
    double metallic = 1, roughness = 1;
    std::optional<double> ior;
    std::optional<Specular> specular;
    std::optional<Sheen> sheen;
    std::optional<Clearcoat> clearcoat;
    std::optional<Anisotropy> anisotropy;
    std::optional<Iridescence> iridescence;
};

/// The bytes of a binary glTF 2.0 file (.glb): one scene with one node, whose mesh is `surface`
/// with `material`. `extras`, the text of a JSON object or empty, becomes the material's "extras".
/// Throws NumericError for a number that is not finite, and UsageError for a surface without
/// triangles or above 4 GiB.
std::string glbBytes(const GltfMaterial& material, const Surface& surface,
                     const std::string& extras = {});

/// Numbers of every vertex of a mesh, by a name of the specification or one with an underscore
/// before it.
struct GlbAttribute {
    std::string name;
    std::size_t components = 3;     ///< 1 to 4
    std::span<const float> values;  ///< [vertex][component]
};

/// Triangles with one colour of diffuse reflection.
struct GlbPart {
    std::string name;
    MaterialColour baseColour{1, 1, 1};
    std::vector<std::uint32_t> indices;
};

/// The bytes of a binary glTF 2.0 file (.glb): one mesh of parts that share their vertices, whose
/// +z is up; its node turns that to +y. Attributes are 32-bit floats, POSITION among them.
/// `extras`, the text of a JSON object, are the mesh's. Throws as glbBytes does.
std::string glbBytes(const std::string& name, std::span<const GlbAttribute> attributes,
                     std::span<const GlbPart> parts, const std::string& extras);

}  // namespace hshfit::inline materials
