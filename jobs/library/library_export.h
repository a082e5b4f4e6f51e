#pragma once

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/material_library/library.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct LibraryExportOptions {
    /// Languages and containers, with commas; all: those that hold a library.
    std::string targets = "bin,glsl,glsl-es,hlsl,metal,wgsl";
    std::string prefix = "hsh";  ///< of the names in shaders
    bool ownSums = false;        ///< gpu::foldedSums: faster shaders, larger texels
    bool force = false;
};

/// Whether a library can be this target: containers, and shaders but OSL's.
bool holdsLibrary(const gpu::Target& target);

struct ExportedLibrary {
    std::string name;                    ///< of the files
    std::vector<std::string> materials;  ///< by their number in the shader
    std::vector<std::string> leftOut;    ///< materials that are not in the basis
    std::size_t components = 0;
    std::size_t bytes = 0;  ///< of the texels of one material
    std::vector<gpu::ExportedFile> textures;
    std::vector<std::string> shaders;
};

/// Writes one shader for all materials that a library has in its basis, and their numbers as
/// texels: NAME_hsh.glsl and so on, NAME.coef.…, NAME.hsh.json (which names the materials) and
/// NAME_test.json, NAME being the library's. Throws InputError for a library without a basis or
/// without a material in it, UsageError for targets that a library has not, OutputError.
ExportedLibrary exportLibrary(const std::string& path, const std::string& folder,
                              const LibraryExportOptions& options);

}  // namespace hshfit::jobs
