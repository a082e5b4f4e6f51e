#pragma once

#include "kept_rows.h"
#include "scene_surfaces.h"
#include "transfer.h"

#include <hshfit/files/file_set.h>
#include <hshfit/precomputed_transfer/lit_transfer.h>
#include <hshfit/precomputed_transfer/transfer_page.h>

#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A light with a name that files and pages show.
struct NamedLight {
    std::string name, file;  ///< `file`: the part of a file's name
    std::vector<Light> lights;
};

/// The scene's own lights as "scene", if it has any, then the lights of the specifications. Throws
/// as parseLights does.
std::vector<NamedLight> namedLights(const scene::Scene& read,
                                    const std::vector<std::string>& specifications);

/// All that a picture needs.
struct PictureScene {
    const TransferMesh& mesh;
    const RayScene& rays;
    const TransferView& transfer;
    const std::vector<TransferMaterial>& materials;
    const SceneSurfaces& surfaces;
};

/// A page of the scene under `lights`, under lightExamples(), and under sun and
/// sky from morning to evening, with the materials of the scene and those that may replace them.
std::string pageOf(const PictureScene& scene, const std::vector<PageKind>& kinds,
                   const MatrixClusters* clusters, const std::vector<NamedLight>& lights,
                   const std::vector<const Camera*>& cameras, std::vector<PageReference> references,
                   const Transferred& done, const Listener& listener);

/// Coefficients of a light in `order` bands.
LightCoefficients lightOf(const NamedLight& light, int order);

/// Results of takePictures beside its files.
struct ReferencePictures {
    std::vector<PageReference> references;
    /// Rows of the pictures, to be removed when all is written; none without `resume`.
    std::vector<std::unique_ptr<KeptRows>> kept;
};

/// CAMERA_LIGHT_transfer.png and CAMERA_LIGHT_path.png at one exposure for each camera and light,
/// with the error by order in `done`. Neither shows what is seen directly.
ReferencePictures takePictures(const PictureScene& scene, const scene::Scene& read,
                               const std::vector<const Camera*>& cameras,
                               const std::vector<NamedLight>& lights, const TimeLimit& limit,
                               const Listener& listener, FileSet& files, Transferred& done);

}  // namespace hshfit::jobs
