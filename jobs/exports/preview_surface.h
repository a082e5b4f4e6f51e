#pragma once

#include <hshfit/materials/usd.h>

#include <brdfs/rows/model.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

/// UsdPreviewSurface as gltf-pbr with some of its parameters: with metallicFactor = 0 both have the
/// same Lambert term and lobe. The specification gives metals no brighter edge (F90 is the albedo);
/// gltf-pbr, three.js and others give them Schlick's. metallicFactor has to be 0 or 1, because the
/// specification leaves open what is interpolated between. The coat has the index of the base,
/// gltf-pbr's coat the index 1.5.

/// The parameters of a gltf-pbr for which UsdPreviewSurface has no input, or that it holds with
/// other values only.
std::vector<std::string> outsidePreview(const Parameters& gltf);

/// A model to fit, and the optional parts of it (FitOptions::parts).
struct PreviewModel {
    std::string model, parts;
};
/// The models whose best is a UsdPreviewSurface: dielectrics with an index or a coat, a metal.
/// `parts` as of an export; throws UsageError for names of parts, which MaterialX has others of.
std::vector<PreviewModel> previewModels(const std::string& parts);

/// A gltf-pbr that has nothing outside.
UsdPreviewSurface previewOf(const Parameters& gltf);

}  // namespace hshfit::jobs
