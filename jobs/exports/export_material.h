#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>
#include <jobs/exports/export.h>
#include <jobs/source/quality.h>

#include <brdfs/fit/choose_parts.h>
#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/pictures/picture_error.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct MaterialExportOptions {
    std::string targets = "gltf";  ///< gpu::selectTargets, materials alone
    std::string name = {};         ///< of the files; empty: from the input
    /// The BRDF that the loss is measured against; empty: the source of the
    /// coefficient file or of the fit, or the input itself.
    std::string source = {};
    std::string mesh = {};       ///< path, +y up; empty: a sphere
    std::string parts = "auto";  ///< FitOptions::parts
    bool force = false;          ///< replace existing files
    bool advise = true;          ///< FitOptions::advise
};
/// The options that materials alone have.
OptionRows<MaterialExportOptions> materialExportOptions();
/// `own` with those that exports of coefficients have, too.
MaterialExportOptions withShared(const ExportOptions& shared, MaterialExportOptions own);

/// One file: a standard material.
struct ExportedMaterial {
    std::string target, path;
    std::size_t bytes = 0;
    std::string spec;     ///< of the material, which opens it as a BRDF
    bool fitted = false;  ///< to the input, rather than being the input
    bool converged = true;
    std::optional<brdfs::PartSearch> search = {};
    std::optional<Poor> poor = {};             ///< of the fit
    std::optional<PictureError> picture = {};  ///< against the source
    std::optional<PairSummary> loss = {};      ///< the same over pairs of directions
    std::string reason = {};                   ///< why there is neither
    std::string pictures = {};  ///< a PNG beside it: source, material, difference; empty: no source
    std::string content = {};   ///< of the file
};

struct ExportedMaterials {
    std::string name, source;
    std::size_t vertices = 0, triangles = 0;
    std::vector<ExportedMaterial> files;
};

/// The answer "hshfit-export-materials" (docs/schemas/export_materials.schema.json).
nlohmann::ordered_json materialsJson(const ExportedMaterials& exported, const std::string& folder);

/// The name of files made from a BRDF or a coefficient file: its path's stem, or the preset's or
/// model's name.
std::string exportName(const std::string& input);

/// Whether a list of targets names materials; throws UsageError for a mixture with other targets.
bool areMaterials(const std::string& targets);

/// The loss of a material as JSON: picture error, mean log error, maximum with its directions,
/// albedo; or the reason why there is none.
nlohmann::ordered_json lossJson(const ExportedMaterial& material);

/// The materials of exportMaterials, without a file.
ExportedMaterials makeMaterials(const std::string& input, const MaterialExportOptions& options,
                                const Listener& listener = {});

/// Writes `input` as standard materials to `folder`: all files or none. A specification or preset
/// of the models gltf-pbr and openpbr is written as it is; anything else, and the source of a
/// coefficient file, is fitted first, by the default loss of fit(). The target gltf takes gltf-pbr;
/// materialx takes either, and openpbr for anything else; usd takes a gltf-pbr that
/// UsdPreviewSurface holds, and comes with materialx. Colours are linear Rec. 709. Where the
/// source opens, NAME_TARGET.png shows spheres of source, material and difference (PictureStrip).
/// Throws UsageError, InputError, NumericError and OutputError.
ExportedMaterials exportMaterials(const std::string& input, const std::string& folder,
                                  const MaterialExportOptions& options,
                                  const Listener& listener = {});

}  // namespace hshfit::jobs
