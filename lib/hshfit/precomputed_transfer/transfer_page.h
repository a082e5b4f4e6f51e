#pragma once

#include <hshfit/precomputed_transfer/matrix_clusters.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// Transfer of one kind as a page can show it: vectors of `channels` channels.
struct PageKind {
    std::string name;
    std::size_t channels = 1;
    std::span<const float> vectors;  ///< [vertex][channel][slot]
};

/// A light that the page can choose, with RGB on the sphere of the page's order; or a light that
/// changes, by coefficients at times between which the page interpolates.
struct PageLight {
    std::string name;
    LightCoefficients coefficients = {};
    std::vector<PageLight> times = {};
    double stops = 0;  ///< exposure to begin with
};

/// A picture by path tracing under one of the lights.
struct PageReference {
    std::string camera, light, note;
    double stops = 0;
    std::string png;
};

struct TransferPageInput {
    std::string title, summary;
    const TransferMesh& mesh;
    int order = 0, localOrder = 0;
    std::size_t channels = 1;  ///< of the clusters' matrices
    std::vector<PageKind> kinds = {};
    /// The materials of the scene come first, then the materials that may replace them; at most 64
    /// in all.
    std::vector<TransferMaterial> materials = {};
    std::size_t sceneMaterials = 0;
    const MatrixClusters* clusters = nullptr;  ///< none: responses are not used
    std::vector<PageLight> lights = {};
    std::vector<Camera> cameras = {};
    std::vector<PageReference> references = {};
    std::vector<std::string> notes = {};
};

/// One self-contained HTML page (WebGL 2, no network): the scene under light that is chosen and
/// turned by its coefficients, with materials that are exchanged, beside the reference
/// pictures. Throws UsageError without a light or a camera, for lights of another order and for
/// more than 64 materials.
std::string transferPage(const TransferPageInput& input);

}  // namespace hshfit::inline precomputed_transfer
