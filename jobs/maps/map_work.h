#pragma once

#include "measured_texels.h"
#include "model_lobes.h"
#include "parameter_maps.h"
#include "svbrdf.h"

#include <hshfit/material_maps/lobe_texels.h>
#include <hshfit/material_maps/map_sidecar.h>
#include <hshfit/time_limit.h>

#include <memory>
#include <string>

namespace hshfit::jobs {

/// Names of the files of a map.
inline constexpr const char* textureName = "material.ktx2";
inline constexpr const char* sidecarName = "material.json";
inline constexpr const char* pictureName = "errors.png";
inline constexpr const char* libraryName = "material.library";

/// Throws UsageError for a description whose texels turn: coefficients of a common frame do not.
void requireOneFrame(const MaterialDescription& described);

/// Texels of a model with parameter maps.
struct ModelTexels {
    ModelTexels(const MaterialDescription& described, const Basis& basis,
                const SvbrdfOptions& options, Processes& processes, const Listener& listener);

    ParameterMaps maps;
    ModelLobes lobes;
    TexelLayout layout;
    LeastCaptured least = {};
    LobeGrid table;
    ModelRows rows;
    LobeTexels texels;
    TexelKernel kernel;
};

/// Everything that texels come from: a model, or measured ones.
struct MapWork {
    MapWork(const std::string& description, const SvbrdfOptions& options, Processes& processes,
            const Listener& listener);

    void checkIntact() const { model ? model->maps.checkIntact() : measured->checkIntact(); }
    /// The head that texels of any form have, of the form outgoing.
    MapSidecar head(const SvbrdfOptions& options, const std::vector<LevelSize>& levels) const;

    TimeLimit time;  ///< of SvbrdfOptions::seconds
    MaterialDescription described;
    std::unique_ptr<Basis> basis;
    std::unique_ptr<ModelTexels> model;
    std::unique_ptr<MeasuredTexels> measured;
    TexelSource& texels;
    const TexelLayout& layout;
    Laws laws;
};

}  // namespace hshfit::jobs
