#pragma once

#include "export.h"

#include <hshfit/brdf/brdf.h>
#include <hshfit/files/file_set.h>
#include <hshfit/gpu/three/three_files.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Lookups in the environment of three.js for all materials of a library, which are isotropic.
gpu::ThreeLookUps threeLookUps(std::size_t materials,
                               const std::function<std::unique_ptr<Brdf>(std::size_t)>& open,
                               const std::string& prefix, const std::string& name,
                               const ProgressCall& progress);

/// Adds the files of a material to `files`; returns their paths. A package.json that stands in the
/// folder stays, with a note, unless files are replaced.
std::vector<std::string> writeThreeFiles(std::span<const gpu::TextFile> made, bool force,
                                         const Listener& listener, FileSet& files);

/// Adds the modules and the page of the target three to `files` and `exported`. `brdf` is what is
/// shown, or its source.
void writeThree(const Brdf& brdf, const ExportOptions& options, const Listener& listener,
                FileSet& files, Exported& exported);

}  // namespace hshfit::jobs
