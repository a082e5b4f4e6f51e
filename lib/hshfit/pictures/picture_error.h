#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/pictures/sphere.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// A mean over the lights, and the light with the largest value.
struct OverLights {
    double mean = 0, largest = 0;
    std::string light = {};
};

/// A relative difference of one channel at a pair of directions.
struct SeenDifference {
    double value = 0;
    std::string channel = {};  ///< "R", "G", "B" or "grey"
    DirectionPair at = {};
};

/// The distance of a BRDF g from a source f to the eye.
///
/// Spheres 4 degrees wide of both are drawn under `pictureLights()`. `flip` is HDR-FLIP (Andersson
/// et al. 2021, 10.1145/3478512.3480938): in each pixel the largest FLIP (flip.h) over up to four
/// exposures, from that which shows half of the lit pixels of the source's sphere below 0.8 of
/// white to the exposure of its brightest pixel; 0 to 1, the mean over the lit part of the sphere.
/// `colour` is CIEDE2000 at the exposure that shows 95 % of the pixels below 0.8 of white, at most
/// nine stops above the exposure of the brightest pixel; the mean over the sphere.
///
/// Shape, along `highlightLines()` and for each channel: the deepest dip and the highest peak that
/// the source does not have (false_extrema.h) of ln(g + m / 20 + 0.001), m the largest channel, as
/// a share of the value; `ridge`: the largest |g - f| / max(f, m / 20 + 0.001) on `mirrorRidges()`.
///
/// Channels are R, G and B as in channel_colours.h; one, "grey", if both have no colour. Values of
/// a BRDF that are below 0 or not finite count as 0. Shares are 0.01 for one percent.
struct PictureError {
    std::vector<std::string> channels = {};
    OverLights flip = {}, colour = {};
    /// The largest (albedo of g - albedo of f) / max(albedo of f, m / 20 + 0.001) per channel for
    /// theta_o = 0, 5, … 85 degrees, and for 89 degrees, with its sign.
    std::vector<double> albedo = {}, lastAlbedo = {};
    SeenDifference dip = {}, peak = {}, ridge = {};
};

struct SeenBrdf;  // pictures and lines of one BRDF

/// A source, with its pictures drawn once, against which others are measured. From many threads.
class PictureReference {
public:
    explicit PictureReference(const Brdf& f);
    ~PictureReference();
    PictureReference(PictureReference&&) noexcept;

    PictureError errorOf(const Brdf& g) const;
    /// `errorOf` the source itself, from its pictures.
    PictureError errorOfItself() const;
    /// `flip` of `errorOf`, or none where its mean exceeds `most`: lights are drawn, points first
    /// and those that need albedos last, until that is certain.
    std::optional<OverLights> flipWithin(const Brdf& g, double most) const;

private:
    PictureError errorOf(const SeenBrdf& other) const;

    std::unique_ptr<const SeenBrdf> seen_;
};

/// HDR-FLIP of two pictures of a sphere under one light, as PictureError has it: the mean over the
/// pixels that are lit in either. Of the same size.
double sphereFlip(const SpherePicture& reference, const SpherePicture& test);

/// The same for one pair; the digits do not depend on the number of threads.
PictureError pictureError(const Brdf& f, const Brdf& g);

/// The value for people: "12 %", "0 %" below 0.005 %, "12 times" from tenfold on.
std::string shareText(const SeenDifference& difference);
/// A text for people: five lines without indentation, each ended, the last degrees last.
std::string textOf(const PictureError& error);
/// "FLIP 0.041, CIEDE2000 1.2, false dip 12 %, false peak 0 %, mirror direction off by 8 %"
std::string summaryOf(const PictureError& error);

}  // namespace hshfit::inline pictures
