#pragma once

#include <jobs/common/inputs.h>
#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>
#include <jobs/source/quality.h>

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/proposals/proposal_record.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/viewer_light.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct ExportOptions {
    std::string targets = "bin,glsl-es";  ///< gpu::selectTargets
    std::string name = {};                ///< of the files; empty: the coefficient file's
    /// The BRDF that the error is measured against; empty: the one that the coefficients name.
    std::string source = {};
    /// Set of the textures; empty: the coefficients', and forms that have a shader of their
    /// own (gpu/forms) are exported as they are. Given, those are projected anew.
    std::string outgoing = {};
    std::string basis = "hsh";  ///< of the form halfway projected anew
    int order = 7;              ///< likewise
    /// Specifications of lights (light/catalog.h) that the viewer offers as its environment, each
    /// on its own; empty: studio.
    std::vector<std::string> lights = {};
    /// The place of three.js for the page of the target three, a path or an address; empty: the
    /// default of gpu::ThreeOptions.
    std::string library = {};
    /// Number type of the texels; none: `pack.number`, and for a form exported as it is, the type
    /// of the fewest bytes that holds the file.
    std::optional<gpu::Number> number = {};
    gpu::Storage storage = gpu::Storage::automatic;  ///< of such a form in shaders
    /// Accept an export that is more than twice as far from its source as its file.
    bool allowLoss = false;
    gpu::PackOptions pack = {};  ///< fewer bands of the chroma imply that it is stored
    gpu::ShaderOptions shader = {};
    bool measureError = true;
    /// A proposal for sampling in the sidecar and functions for it in the shaders; none: if there
    /// are shaders among the targets, as text or compiled.
    std::optional<bool> sampling = {};
    bool zstd = false;   ///< compress KTX2
    bool force = false;  ///< replace existing files
};
/// Also has the options that exports of materials, maps and lighting share (`inputs` of the rows).
OptionRows<ExportOptions> exportOptions();

/// The kinds of exports that an option is for (OptionRow::inputs).
namespace exports {
inline constexpr unsigned coefficients = 1, materials = 2, maps = 4, lighting = 8;
}

/// Mean |ln(1 + f cos(theta_i)) - ln(1 + g cos(theta_i))| over spreadPairs() against the BRDF that
/// was projected, of the coefficient file and of its export.
struct ExportLoss {
    std::size_t pairs = 0;
    double file = 0, exported = 0;
};

/// The error of what was exported, or why it is not known. `loss` is there for forms exported as
/// they are, `split` for coefficients per outgoing direction.
struct ExportError {
    std::optional<gpu::ErrorSplit> split;
    std::string reason;
    std::optional<ExportLoss> loss = {};
    std::optional<PictureError> picture = {};  ///< of the textures as shaders read them
};
/// The object "fit_error" of sidecars and answers.
nlohmann::ordered_json errorJson(const ExportError& error);

/// A shader, as text or compiled, the bindings of a compiled one, a viewer or a file of a module.
struct ExportedText {
    std::string role, target, path;
};

struct Exported {
    std::string name;
    gpu::Payload payload;                            ///< empty for a form exported as it is
    std::optional<gpu::FormPayload> form;            ///< a form exported as it is
    gpu::Storage storage = gpu::Storage::automatic;  ///< of its shaders
    ExportError error;
    std::optional<gpu::ProposalRecord> proposal;  ///< for sampling, where asked for
    double proposalSeconds = 0;                   ///< that its fit and efficiency took
    std::optional<Poor> poor;
    std::string sidecar, test;  ///< names of files in the folder, as below
    std::vector<gpu::ExportedFile> textures;
    std::vector<ExportedText> texts;
    std::vector<gpu::ViewerLight> lights;  ///< of the viewer
};

/// Exports a coefficient file to `folder` as textures, shaders and a viewer with their error:
/// all files or none. Forms without a shader of their own, or with `outgoing`, are projected to
/// coefficients per outgoing direction.
/// With the targets "all", those that cannot hold the coefficients are left out, with a note.
/// Throws UsageError for contradictory options, InputError, NumericError (for an export more than
/// twice as far from its source as its file, too) and OutputError.
/// A failed measurement of the error is thrown only if `source` is given.
Exported exportCoefficients(const std::string& coefficients, const std::string& folder,
                            const ExportOptions& options, const Listener& listener = {});

/// The inputs of an export of several, folders and patterns expanded, and the folder of each below
/// `folder`, named after it. Throws UsageError if two are equal, OutputError if a file stands in
/// the place of `folder`.
struct ExportPlaces {
    std::vector<std::string> inputs, folders;
};
ExportPlaces exportPlaces(const std::vector<std::string>& inputs, const std::string& folder);

}  // namespace hshfit::jobs
