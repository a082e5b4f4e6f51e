#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/viewer_reference.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu {

/// What a viewer page shows: one material, in one or two bases, next to itself.
struct ViewerInput {
    std::string title;
    /// One or two, grey or RGB, in the order of the panes. Shown as they are if float16; from
    /// other numbers, what a GPU would read is rounded to float16. Basis textures are left out.
    std::vector<Payload> payloads;
    std::optional<ReferenceTable> reference = {};
    std::string noReference = "The source is not known.";  ///< shown where there is none
    /// Bands of the environment, which all panes share: 2 to 10.
    int environmentOrder = 7;
};

/// One self-contained HTML page (WebGL 2; opens from disk, asks nothing of a network): a sphere and
/// a teapot under a point light and an environment; exact, both bases and their difference side by
/// side or as one picture with dividers; order, exposure, and numbers (docs/viewer.md). The panes
/// of the payloads run `shaderSource` of GLSL ES as it is exported; lower orders are stored bands
/// set to 0, which is what a lower order stores for every basis but lsosh. Throws UsageError for
/// spectral payloads, more than two, or none.
std::string viewerPage(const ViewerInput& input);

/// Writes viewerPage(input) to `path`, complete or not at all. An existing file is replaced only
/// with `force`; OutputError otherwise, and where it cannot be written.
void writeViewer(const std::string& path, const ViewerInput& input, bool force = false);

/// What the viewer of exported coefficients shows: `payload`; the same outgoing directions, order
/// and quantity in SH (in HSH where `payload` is in SH), projected from `source`; and `source`
/// tabulated. Where the projection fails, or `source` is null, the page says so instead.
ViewerInput viewerInput(Payload payload, const Brdf* source,
                        std::function<void(std::size_t, std::size_t)> progress = {});

}  // namespace hshfit::gpu
