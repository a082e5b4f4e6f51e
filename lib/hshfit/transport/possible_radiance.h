#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/light/lights.h>
#include <hshfit/transport/surface_scene.h>

#include <optional>
#include <span>
#include <string>

namespace hshfit::inline transport {

/// Radiance as it goes into a picture file.
struct CheckedPicture {
    std::string name;  ///< for messages
    int width = 0;
    std::span<const float> radiance;    ///< [row][column][R, G, B]
    std::span<const float> error = {};  ///< standard errors likewise; empty: of no pixel
    int samples = 0;                    ///< that a pixel is the mean of; 0: of none
};

/// The largest radiance that comes from far away, over directions and colours, 0 without light. Of
/// skies and coefficients the largest at every degree and at the sun, and a twentieth more. None
/// where a light is directional, whose radiance is infinite.
std::optional<double> brightestOf(std::span<const Light> lights);

/// The largest directional albedo of a BRDF over outgoing directions and channels (AlbedoTable),
/// and twice the error of its quadrature more.
double largestAlbedo(const Brdf& brdf);

/// Throws NumericError, which names picture, pixel, value and bound, for a value that is not finite
/// or that the light of a scene cannot make. With L the radiance of the brightest light or emitter
/// and a < 1 the largest albedo, all radiance is at most L + a L + a^2 L + … = L / (1 - a). There
/// is no bound where a surface reflects all light or more, and under directional light.
///
/// A mean of samples may lie above its expectation. From 16 samples on, it counts as beyond the
/// bound by six standard errors; a mean over the whole picture always, if it is a thousand times
/// the bound, since non-negative estimates do that once in a thousand pictures at most (Markov).
void requirePossible(const CheckedPicture& picture, const SurfaceScene& scene,
                     std::span<const Light> lights);

/// For one reflection by one BRDF, where the bound is L, or a L for a above 1.
void requirePossible(const CheckedPicture& picture, const Brdf& brdf,
                     std::span<const Light> lights);

}  // namespace hshfit::inline transport
