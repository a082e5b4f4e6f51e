#pragma once

#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/forms/library_shader.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/shader.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::gpu::inline three {

/// Lookups in an environment that three.js has prefiltered (lighting/prefiltered_lobes.h), as the
/// room above hands them down.
struct ThreeLookUps {
    std::string wgsl = {};  ///< the snippet, with a texture, cube and sampler of its own
    std::string glsl = {};  ///< PREFIX_prefiltered, on the macro PREFIX_PREFILTERED_LIGHT
    /// For as many levels as `first` and for one more, of one size; float16 or float32; of a
    /// library a row for each material.
    std::array<Texels, 2> texels = {};
    bool along = false;                           ///< the function takes a tangent
    std::vector<double> first = {}, second = {};  ///< zonal coefficients of bands 1 and 2 by level
};

struct ThreeOptions {
    std::string name;           ///< what the files' names begin with
    ShaderOptions shader = {};  ///< `environmentOrder`: bands of the light from all around
    Storage storage = Storage::automatic;  ///< of a form; `block` becomes `texture`
    ThreeLookUps lookUps = {};
    std::string library = "./node_modules/three";  ///< where the page finds three.js
    std::string fitError = {};                     ///< JSON, as in the sidecar
};

/// A file by its path in the folder of the export, and its text.
struct TextFile {
    std::string path, text;
};

/// Throws UsageError for a name that no import takes, and for more materials than 2048, the rows of
/// a texture that every device takes.
void checkThree(const std::string& name, std::size_t materials = 1);

/// A material for three.js from release 187 on: NAME_three.js (ShaderMaterial, WebGL 2),
/// NAME_three_webgpu.js (NodeMaterial with WGSL), NAME_three_data.js, which both import, their
/// types, a page that shows a sphere, and last a package.json. The shaders are shaderSource() and
/// formShaderSource(); numbers beyond what both APIs filter become float32 as a sampler returns
/// them. Basis textures are left out. Throws UsageError for spectral materials and names that no
/// import takes.
///
/// Units: radiance = f cos(theta_i) times the colour and intensity of a light, as in three.js.
std::vector<TextFile> threeFiles(const Payload& payload, const ThreeOptions& options);
std::vector<TextFile> threeFiles(const FormPayload& payload, const ThreeOptions& options);

/// The same for all materials of a library, at most 2048: the shader is libraryShaderSource(), and
/// the class takes the number or the name of a material, or numbers from an attribute. `names`: of
/// the materials. Throws as checkThree().
std::vector<TextFile> threeFiles(const SharedSums& library, const std::vector<std::string>& names,
                                 const ThreeOptions& options);

}  // namespace hshfit::gpu::inline three
