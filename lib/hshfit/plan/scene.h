#pragma once

#include <hshfit/directions.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hshfit::plan {

/// Linear Rec. 709.
using Rgb = std::array<double, 3>;

/// A round light of uniform radiance, `radius` radians from its centre to its rim.
struct DiscLight {
    Direction towards;
    double radius = 0;
    Rgb radiance{};
};

/// A flat panel of uniform radiance that faces the surface: `width` (along azimuth) and `height`
/// (along elevation) are the angles, in radians, under which its axes are seen; then turned about
/// its centre by `turn`.
struct PanelLight {
    Direction towards;
    double width = 0, height = 0, turn = 0;
    Rgb radiance{};
};

/// The half space above the world's horizon, and a uniform ground below it.
/// uniform   L = zenith
/// overcast  L = zenith (1 + 2 cos theta) / 3   (Moon & Spencer 1942; CIE standard overcast sky)
struct SkyLight {
    enum class Model { uniform, overcast };
    Model model = Model::uniform;
    Rgb zenith{}, ground{};
};

/// A latitude-longitude picture: row 0 around the zenith; azimuth pi at the left edge, 0 in the
/// middle, -pi at the right edge, plus `turn`. Radiance is constant within a pixel.
struct PictureLight {
    std::string file;
    std::size_t width = 0, height = 0;
    std::vector<float> rgb;  ///< [row][column][R, G, B], scaled
    double turn = 0;
};

using Light = std::variant<DiscLight, PanelLight, SkyLight, PictureLight>;

/// How a surface lies in the world, where +z is up: its normal, and the turn of its tangent about
/// it. Without a turn the tangent is +x, carried along as +z goes to the normal on a great circle.
struct Orientation {
    double theta = 0, phi = 0, turn = 0;  ///< radians
};

/// Directions to the viewer that occur, about the normal and from the tangent, radians.
struct ViewRange {
    double thetaMin = 0, thetaMax = 85 * (pi / 180);
    double phiMin = 0, phiMax = 2 * pi;
    /// Surfaces are turned about their normals in any way: every orientation is tried in 8 turns.
    bool anyTangent = false;
};

/// How far outgoing radiance may be off, over views (by solid angle), orientations and channels.
/// relativeL2  root of the sum of (L' - L)^2 over that of L^2
/// log         mean |ln(max(L', 0) + e) - ln(L + e)|, e = 1/100 of the mean of L: what the eye sees
struct Budget {
    enum class Metric { relativeL2, log };
    Metric metric = Metric::relativeL2;
    double error = 0.05;
};
std::string_view metricName(Budget::Metric metric);  ///< "relative_l2", "log"

struct Limits {
    std::size_t bytes = 245760;         ///< a fifth of HSH order 10 on 32 x 32, RGB float32
    std::optional<double> nanoseconds;  ///< a pair, in batches of 4096; with PlanOptions::byTime
};

struct Material {
    std::string name;  ///< of its file as well: letters, digits, '-', '_', '.'
    std::string brdf;  ///< a specification
    std::string lobe =
        {};  ///< a specification that may be taken out first (from `fit`); may be empty
    std::vector<Orientation> orientations = {{}};
    Budget budget = {};
};

struct Scene {
    std::string file;
    std::vector<Material> materials;
    std::vector<Light> lights;
    ViewRange views;
    Limits limits;
};

/// Reads a scene (docs/plan.md, docs/schemas/scene.schema.json). Pictures are looked for beside the
/// scene file. Throws InputError that names file and field, for unknown keys with the valid ones.
Scene readScene(const std::string& path);

}  // namespace hshfit::plan
