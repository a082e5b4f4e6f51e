#pragma once

#include <hshfit/light/picture_light.h>
#include <hshfit/specification/parameters.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// The syntax of a sum of lights, in one line.
inline constexpr std::string_view lightSumHelp =
    "any specifications joined by '+': 'sky:type=12,elevation=40+sun:elevation=40,irradiance=3'";

/// A light specification and its lights, whose radiances add up.
struct LightSpecification {
    std::string text;
    std::vector<Light> lights;  ///< in the order of the text; several for the term studio
    /// The terms as the text has them. A path may contain '+', so that the text alone does not
    /// tell.
    std::vector<std::string> terms = {};
};

/// Parses "TERM + TERM + …", spaces or none around '+', each term
///     kind[:key=value,…] | path of a picture or of light coefficients[:key=value,…]
/// with the kinds and keys of the table below. World frame: right-handed, +z up; `elevation` from
/// the horizon and `azimuth` from +x towards +y, degrees; a place, date and time means +x east and
/// +y north. Throws UsageError for an unknown kind, key or value (naming the valid ones) and
/// InputError for a picture that is absent or invalid.
/// Paths are relative to `folder`, "" for the current one.
LightSpecification parseLights(const std::string& text, const std::string& folder = "",
                               InvalidPixels invalid = InvalidPixels::refused);

/// Whether a text begins with the path of a picture that is light rather than a table of a BRDF:
/// any format but OpenEXR; an OpenEXR picture twice as wide as high, or with `layout` or `curve`
/// behind its path, that has none of the program's own attributes; or with the path of a file of
/// light coefficients.
bool looksLikeLight(const std::string& text);

/// Whether a text begins with a kind of light, "sky:…" or "uniform", rather than a path.
bool namesLight(std::string_view text);

/// One row of the table of lights.
struct LightKind {
    std::string_view name;
    std::string_view help;
    std::string_view source;  ///< of the formula; may be empty
    std::string_view example;
    std::vector<Parameter> parameters;  ///< `scale` and `turn` included
    /// The light without scale and turn. `owner` starts messages.
    Light (*make)(std::string_view owner, const Parameters& parameters);
};

/// The analytic lights.
std::span<const LightKind> lightKinds();

/// The examples of the kinds that need no file.
std::vector<std::string> lightExamples();

/// The name of several lights: a sky and three soft panels, which viewers and previews have where
/// no light is given. `make` is null.
const LightKind& studioKind();

/// Pictures and files of coefficients, which a path stands for; `make` is null.
const LightKind& pictureKind();
const LightKind& coefficientsKind();

}  // namespace hshfit::inline light
