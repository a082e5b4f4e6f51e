#pragma once

#include "listener.h"
#include "quality.h"

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/viewer_light.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct ExportOptions {
    std::string targets = "bin,glsl-es";  ///< gpu::selectTargets
    std::string name = {};                ///< of the files; empty: that of the coefficient file
    /// The BRDF that the error is measured against; empty: the one that the coefficients name.
    std::string source = {};
    std::string outgoing = {};  ///< set of the textures; empty: that of the coefficients
    std::string basis = "hsh";  ///< for the form halfway
    int order = 7;              ///< for the form halfway
    /// Specifications of lights (light/catalog.h) that the viewer offers as its environment, each
    /// on its own; empty: gpu::studioLight.
    std::vector<std::string> lights = {};
    gpu::PackOptions pack = {};
    gpu::ShaderOptions shader = {};
    bool measureError = true;
    bool zstd = false;   ///< compress KTX2
    bool force = false;  ///< replace existing files
};

/// The error of what was exported, or why it is not known.
struct ExportError {
    std::optional<gpu::ErrorSplit> split;
    std::string reason;
};
/// The object "fit_error" of sidecars and answers.
nlohmann::ordered_json errorJson(const ExportError& error);

/// A shader or a viewer.
struct ExportedText {
    std::string role, target, path;
};

struct Exported {
    std::string name;
    gpu::Payload payload;
    ExportError error;
    std::optional<Poor> poor;
    std::string sidecar, test;  ///< names of files in the folder, as those below
    std::vector<gpu::ExportedFile> textures;
    std::vector<ExportedText> texts;
    std::vector<gpu::ViewerLight> lights;  ///< of the viewer
};

/// Exports a coefficient file to `folder` as textures, shaders and a viewer with their error:
/// all files or none. Forms other than coefficients per outgoing direction are projected anew.
/// With the targets "all", those that cannot hold the coefficients are left out, with a note.
/// Throws UsageError for contradictory options, InputError, NumericError and OutputError. A
/// failed measurement of the error is thrown only if `source` is given.
Exported exportCoefficients(const std::string& coefficients, const std::string& folder,
                            const ExportOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
