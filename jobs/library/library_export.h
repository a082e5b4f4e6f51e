#pragma once

#include <jobs/common/listener.h>

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/gpu/forms/library_table.h>
#include <hshfit/material_library/library.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct LibraryExportOptions {
    /// Languages and containers, with commas; all: those that hold a library.
    std::string targets = "bin,glsl,glsl-es,hlsl,metal,wgsl";
    std::string prefix = "hsh";  ///< of the names in shaders
    /// The largest error of ln(f + 0.001) of a table of the functions (gpu::tabledWithin); 0: the
    /// functions stand in the shader, without error but many times as slow. Ten percent is at the
    /// worst pair; the mean is a twentieth of it.
    double tableError = 0.1;
    /// Rows, by elevation, of a proposal for sampling that is fitted to each material, with
    /// `sample` and `pdf` in the shaders; 0: none, which saves up to a second a material.
    std::size_t sampling = 0;
    bool force = false;
};

/// Whether a library can be this target: containers, shaders but OSL's, and three.js.
bool holdsLibrary(const gpu::Target& target);

/// A table of functions, and what f loses by it.
struct ExportedTable {
    gpu::TableSize size;
    std::size_t bytes = 0;
    gpu::TableError error;
    /// FLIP of pictures with the table against those without: the mean over at most 64 materials,
    /// and the largest with its material.
    double flip = 0, largestFlip = 0;
    std::string material = {};
};

/// The object "table" of answers and sidecars.
nlohmann::ordered_json tableJson(const ExportedTable& table);

/// The proposals of materials, and how far samples by them are from f: the variance of f cos / pdf
/// relative to the square of its mean, by 4096 samples, and the same for samples by the cosine.
/// Medians over at most 64 materials.
struct ExportedSampling {
    struct Row {
        double theta = 0;  ///< of wo, degrees
        double variance = 0, largest = 0, cosine = 0;
    };
    std::size_t first = 0, rows = 0;  ///< texels of a material that have them
    std::vector<Row> efficiency;
};

/// The object "sampling" of answers and sidecars.
nlohmann::ordered_json samplingJson(const ExportedSampling& sampling);

struct ExportedLibrary {
    std::string name;                    ///< of the files
    std::vector<std::string> materials;  ///< by their number in the shader
    std::vector<std::string> leftOut;    ///< materials that are not in the basis
    std::size_t components = 0;
    std::size_t bytes = 0;               ///< of the texels of one material
    std::optional<ExportedTable> table;  ///< none: the functions stand in the shaders
    std::optional<ExportedSampling> sampling = {};
    std::vector<gpu::ExportedFile> textures;
    std::vector<std::string> texts;  ///< shaders and modules
};

/// Writes one shader for all materials that a library has in its basis, and their numbers as
/// texels: NAME_hsh.glsl and so on, NAME.coef.…, NAME.basis.… with the table of the functions,
/// NAME.hsh.json (which names the materials) and NAME_test.json, NAME being the library's; for
/// three.js also gpu::threeFiles, with lookups that are fitted to each material. Throws InputError
/// for a library without a basis or without a material in it, UsageError for targets that a library
/// has not, NumericError as gpu::tabledWithin does, OutputError.
ExportedLibrary exportLibrary(const std::string& path, const std::string& folder,
                              const LibraryExportOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
