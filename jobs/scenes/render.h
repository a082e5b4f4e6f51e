#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/number_text.h>

#include <hshfit/brdf/brdf.h>
#include <hshfit/pictures/sphere.h>
#include <hshfit/rendering/lit_picture.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct RenderOptions {
    enum class By { coefficients, integration, both };
    enum class Up { y, z };

    /// Light specifications (light/catalog.h), which add up.
    std::vector<std::string> lights;
    /// Lights about the line of sight, and radiance from all around, in addition.
    SphereRig rig = {.lights = {}, .dome = 0};
    std::string mesh;  ///< path; empty: a sphere
    Up up = Up::y;     ///< of the file, as usual for OBJ files and scans
    By by = By::both;
    std::vector<std::string> bases = {"hsh"};
    std::vector<int> orders = {10};
    bool cosine = false;  ///< coefficients of f cos(theta_i) instead of f
    /// OutgoingSet::parse; empty: 64 elevations if isotropic, else 48x48: interpolated in between.
    std::string outgoing;
    /// Stops that are added to the exposure, a picture for each.
    std::vector<double> exposures = {0};
    std::optional<double> exposure = {};  ///< stops; none: automatic
    int size = 256;
    int samples = 2;         ///< n: n x n a pixel
    Angles view = {75, 0};   ///< direction to the viewer in the world
    double fieldOfView = 0;  ///< of perspective, degrees; 0: parallel lines of sight
    /// Bound of the estimated relative error of integration at a point; none: 5 % of a picture by
    /// integration alone (docs/reference/render.md has real errors), and 0.5 % beside coefficients.
    std::optional<double> tolerance = {};
    /// The time for integration; none: as long as it takes. At its end the picture is what was
    /// reached, but for a first pass over all pixels (renderByIntegration).
    std::optional<double> seconds = {};

    double bound() const {
        constexpr double alone = 0.05;
        return tolerance.value_or(by == By::integration ? alone : IntegrationOptions{}.tolerance);
    }
};

/// The name of a material beside its picture: as it was given for a preset, whose own name is all
/// of its parameters, and for a file of coefficients, which calls itself by the BRDF that it was
/// made from.
std::string shownName(const std::string& spec, const Brdf& brdf);
/// Tells the listener why a picture of what was opened is poor, or black at places.
void remarkContents(const std::string& name, const Brdf& brdf, const Listener& listener);

/// One square of the sheet.
struct RenderedPicture {
    enum class Kind { integration, coefficients, difference };
    Kind kind = Kind::integration;
    std::string brdf;
    std::string basis;  ///< of coefficients and differences
    int order = 0;
    double exposure = 0;               ///< stops on top of the sheet's
    std::size_t row = 0, column = 0;   ///< of its first pixel
    double error = 0;                  ///< LitPicture::error
    LitPicture::Largest largest = {};  ///< of integration
    double evaluations = 0;            ///< of f, the mean over the points of integration
    std::size_t cut = 0, early = 0, notFinite = 0;
    double amplification = 1;  ///< of a difference, in .png files
    /// For coefficients and differences, where there is a picture by integration.
    std::optional<PictureDifference> difference = {};
    /// For coefficients: root of the share of the energy that they miss (Eq. 15), if it exists.
    std::optional<double> missed = {};
};

struct Rendered {
    std::vector<RenderedPicture> pictures;
    std::string mesh;  ///< empty: a sphere
    std::size_t triangles = 0, degenerate = 0;
    std::size_t points = 0;  ///< that radiance was computed for
    double stops = 0;
};

std::string kindName(RenderedPicture::Kind kind);

/// Seconds of an integration, passed and left, from which on `render` says how to end it sooner.
inline constexpr double slowSeconds = 10;
/// That remark, after `done` of `total` steps; empty where little is left or the time has an end.
std::string slowRemark(const std::string& brdf, double seconds, std::size_t done, std::size_t total,
                       const RenderOptions& options);

/// Pictures of materials under any light, a row for each: by integration, then for each basis,
/// order and exposure by coefficients and, with both ways, their difference from integration.
/// Folders stand for their measured and coefficient files. `output`: .png or .exr; differences are
/// amplified magnitudes in a .png and signed in an .exr. Throws UsageError, InputError,
/// NumericError and OutputError.
Rendered render(const std::vector<std::string>& specs, const std::string& output,
                const RenderOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
