#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/viewer_light.h>
#include <hshfit/gpu/viewer_reference.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu {

/// A form exported as it is, beside coefficients per outgoing direction.
struct ViewerForm {
    std::string name;                   ///< of the pane
    std::string prefix = "form";        ///< of the snippet's names
    std::string shader;                 ///< GLSL ES: PREFIX_eval(wo, wi), f in 1/sr
    std::optional<Texels> texels = {};  ///< fetched without a filter, if the snippet has them
    double roughness = 1;               ///< highlightRoughness
    bool spectral = false;
};

/// The input of a viewer page, which shows one material exactly and in one or two bases, or as a
/// form and in one basis.
struct ViewerInput {
    std::string title;
    /// One or two payloads, grey or RGB, in the order of the panes. float16 is shown unchanged; the
    /// values that a GPU reads from other number types are rounded to float16. Basis textures are
    /// left out.
    std::vector<Payload> payloads;
    std::optional<ReferenceTable> reference = {};
    std::optional<ViewerForm> form = {};  ///< shown before the payloads, of which there is one then
    /// Bytes and errors, below the names of the panes: of the form, if there is one, then of the
    /// payloads.
    std::vector<std::string> details = {};
    std::string noReference = "The source is not known.";  ///< shown where there is none
    /// Bands of the environment, which all panes share: 2 to 10.
    int environmentOrder = 10;
    /// The lights that the page can choose from, in `environmentOrder` bands; none: studio.
    std::vector<ViewerLight> lights = {};
};

/// One self-contained HTML page (WebGL 2, no network): a sphere and a teapot under a point
/// light and an environment, one of `lights` or a picture that is dropped in. It shows exact, both
/// bases and their difference, side by side or divided, with controls for order and exposure, and
/// numbers (docs/reference/viewer.md). The environment is turned by rotating its coefficients; a
/// form, which has no product with them, is lit by a mean over directions like the exact pane. The
/// panes of the payloads run `shaderSource` of GLSL ES as it is exported; lower orders set stored
/// bands to 0, which equals a lower order for every basis but lsosh. Throws UsageError for
/// spectral payloads and forms, more than two of both, or no payload, and for lights of another
/// order.
std::string viewerPage(const ViewerInput& input);

/// Writes viewerPage(input) to `path`, complete or not at all. An existing file is replaced
/// only with `force`. Throws OutputError otherwise, and if writing fails.
void writeViewer(const std::string& path, const ViewerInput& input, bool force = false);

/// The viewer of exported coefficients: `payload`; a projection of `source` to SH (to HSH if
/// `payload` is in SH) with the same outgoing directions, order and quantity; and `source`
/// tabulated. If the projection fails or `source` is null, the page shows a message instead.
ViewerInput viewerInput(Payload payload, const Brdf* source,
                        std::function<void(std::size_t, std::size_t)> progress = {});

}  // namespace hshfit::gpu
