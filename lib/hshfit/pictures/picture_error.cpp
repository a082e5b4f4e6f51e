#include <hshfit/pictures/picture_error.h>

#include <hshfit/percent.h>
#include <hshfit/pictures/ciede2000.h>
#include <hshfit/pictures/flip.h>
#include <hshfit/pictures/internal/channel_colours.h>
#include <hshfit/pictures/internal/false_extrema.h>
#include <hshfit/pictures/internal/highlight_lines.h>
#include <hshfit/pictures/internal/picture_lights.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace hshfit::inline pictures {
namespace {

constexpr int pixels = 48;               // along an edge of a picture
constexpr double sphereDegrees = 4;      // the width of the sphere that an observer sees
constexpr double perLargest = 1.0 / 20;  // of the largest channel: less is not seen beside it
constexpr double darkest = 1e-3;         // 1/sr, and of albedos: black

using Rgb = std::array<double, 3>;

double largestOf(const Rgb& rgb) {
    return *std::max_element(rgb.begin(), rgb.end());
}

/// The least value that a relative difference of a channel refers to.
double floorOf(const Rgb& rgb) {
    return perLargest * largestOf(rgb) + darkest;
}

Rgb shown(Rgb rgb) {
    for (double& value : rgb) value = std::isfinite(value) ? std::max(value, 0.0) : 0;
    return rgb;
}

std::vector<Rgb> valuesOn(const HighlightLine& line, const Brdf& brdf,
                          const ChannelColours& colours) {
    std::vector<double> f(brdf.channels().count());
    std::vector<Rgb> values;
    for (const DirectionPair& pair : line.pairs) {
        brdf.eval(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1}, f.data());
        values.push_back(shown(colours(f.data())));
    }
    return values;
}

/// Directions of the albedos: every 5 degrees of theta_o to 85, and 89, at eight azimuths.
std::vector<Direction> albedoDirections() {
    std::vector<Direction> directions;
    for (int theta = 0; theta <= 90; theta += 5)
        for (int turn = 0; turn < 8; ++turn)
            directions.push_back(directionFromAngles(radians(std::min(theta, 89)), turn * pi / 4));
    return directions;
}

RgbPicture exposed(const SpherePicture& sphere, double stops) {
    RgbPicture picture{sphere.size, sphere.size, sphere.radiance};
    const auto factor = static_cast<float>(std::exp2(stops));
    for (std::size_t k = 0; k < picture.values.size(); ++k)
        picture.values[k] *= factor * sphere.coverage[k / 3];
    return picture;
}

/// The largest channel of a pixel.
double brightnessOf(const SpherePicture& sphere, std::size_t k) {
    const float* rgb = sphere.radiance.data() + 3 * k;
    return static_cast<double>(*std::max_element(rgb, rgb + 3));
}

std::vector<double> exposuresOf(const SpherePicture& sphere) {
    std::vector<double> largest;
    for (std::size_t k = 0; k < sphere.coverage.size(); ++k)
        if (sphere.coverage[k] > 0) largest.push_back(brightnessOf(sphere, k));
    return flipExposures(std::move(largest));
}

/// The mean of a value per pixel over the pixels of the sphere that `counts` takes; 0 for none.
template <class Counts, class Value>
double meanOver(const SpherePicture& sphere, const Counts& counts, const Value& value) {
    double sum = 0, covered = 0;
    for (std::size_t k = 0; k < sphere.coverage.size(); ++k) {
        if (sphere.coverage[k] == 0 || !counts(k)) continue;
        sum += static_cast<double>(sphere.coverage[k]) * value(k);
        covered += static_cast<double>(sphere.coverage[k]);
    }
    return covered > 0 ? sum / covered : 0;
}

LinearRgb pixelOf(const RgbPicture& picture, std::size_t k) {
    LinearRgb rgb;
    for (std::size_t c = 0; c < 3; ++c)
        rgb[c] = std::clamp(static_cast<double>(picture.values[3 * k + c]), 0.0, 1.0);
    return rgb;
}

OverLights overLights(std::span<const double> values) {
    OverLights all{.mean = 0, .largest = -1};
    for (std::size_t k = 0; k < values.size(); ++k) {
        all.mean += values[k] / static_cast<double>(values.size());
        if (values[k] <= all.largest) continue;
        all.largest = values[k];
        all.light = pictureLights()[k].name;
    }
    return all;
}

/// The lights by the time that a picture under them takes.
enum class Stage { points, discs, domes };

Stage stageOf(const SphereRig& rig) {
    if (rig.dome > 0) return Stage::domes;
    return rig.lights.size() == 1 ? Stage::points : Stage::discs;
}

/// FLIP and CIEDE2000 under one light.
std::pair<double, double> differences(const SpherePicture& f, const SpherePicture& g) {
    const double brightest = *std::max_element(f.radiance.begin(), f.radiance.end());
    // Where all but the highlight is black, no exposure shows what counts as unlit as white.
    const double stops =
        std::min(automaticExposure({&f, 1}), std::log2(shownAsWhite / (unlitShare * brightest)));
    const RgbPicture reference = exposed(f, stops), test = exposed(g, stops);
    const double colour = meanOver(
        f, [](std::size_t) { return true; },
        [&](std::size_t k) {
            return ciede2000(labOf(pixelOf(reference, k)), labOf(pixelOf(test, k)));
        });
    return {sphereFlip(f, g), colour};
}

/// Keeps the deepest of the dips, or peaks for a sign of -1, along a line.
void keepDeepest(const HighlightLine& line, const std::vector<Rgb>& f, const std::vector<Rgb>& g,
                 std::size_t channel, const std::string& name, double sign, SeenDifference& kept) {
    const auto logarithms = [&](const std::vector<Rgb>& values) {
        std::vector<double> logs;
        for (const Rgb& rgb : values) logs.push_back(sign * std::log(rgb[channel] + floorOf(rgb)));
        return logs;
    };
    const LineDip dip = falseDip(logarithms(f), logarithms(g), line.angles);
    const double depth = relativeDepth(dip.depth);
    if (depth > kept.value) kept = {depth, name, line.pairs[dip.at]};
}

/// The names of the channels of both: one where neither has a colour.
std::vector<std::string> channelsOf(bool grey) {
    return grey ? std::vector<std::string>{"grey"} : std::vector<std::string>{"R", "G", "B"};
}

}  // namespace

double sphereFlip(const SpherePicture& f, const SpherePicture& g) {
    const double perDegree = sphereRadius * f.size / sphereDegrees;
    std::vector<float> largest(f.coverage.size(), 0.0F);
    const double brightest = *std::max_element(f.radiance.begin(), f.radiance.end());
    for (const double stops : exposuresOf(f)) {
        const std::vector<float> seen =
            flip(exposed(f, stops), exposed(g, stops), {.pixelsPerDegree = perDegree});
        for (std::size_t k = 0; k < seen.size(); ++k) largest[k] = std::max(largest[k], seen[k]);
    }
    const double least = unlitShare * brightest;
    return meanOver(
        f, [&](std::size_t k) { return brightnessOf(f, k) > least || brightnessOf(g, k) > least; },
        [&](std::size_t k) { return static_cast<double>(largest[k]); });
}

/// Everything of one BRDF that is compared.
struct SeenBrdf {
    bool isotropic, grey;
    std::vector<SpherePicture> spheres = {};  ///< one for each light
    std::vector<Rgb> albedos = {};            ///< at albedoDirections()
    std::vector<std::vector<Rgb>> lines = {}, ridges = {};

    explicit SeenBrdf(const Brdf& brdf) : isotropic(brdf.laws().isotropic) {
        const ChannelColours colours(brdf.channels());
        grey = colours.grey();
        for (const HighlightLine& line : highlightLines(isotropic))
            lines.push_back(valuesOn(line, brdf, colours));
        for (const HighlightLine& line : mirrorRidges(isotropic))
            ridges.push_back(valuesOn(line, brdf, colours));
        const AlbedoTable table(brdf, AlbedoTable::Detail::coarse);
        for (const PictureLight& light : pictureLights())
            spheres.push_back(
                renderSphere(brdf, table, {.rig = light.rig, .size = pixels, .samples = 1}));
        std::vector<double> values(brdf.channels().count());
        for (const Direction& wo : albedoDirections()) {
            table.at(wo, values);
            albedos.push_back(shown(colours(values.data())));
        }
    }
    /// Lines are ordered by azimuth: the lines of an isotropic BRDF stand for all azimuths.
    const std::vector<Rgb>& line(std::size_t k) const { return lines[k % lines.size()]; }
    const std::vector<Rgb>& ridge(std::size_t k) const { return ridges[k % ridges.size()]; }
};

namespace {

void compareAlbedos(const SeenBrdf& f, const SeenBrdf& g, PictureError& error) {
    const std::vector<Direction> directions = albedoDirections();
    const double horizon = std::cos(radians(85.5));
    error.albedo.assign(error.channels.size(), 0.0);
    error.lastAlbedo = error.albedo;
    for (std::size_t k = 0; k < directions.size(); ++k)
        for (std::size_t c = 0; c < error.channels.size(); ++c) {
            const double source = f.albedos[k][c];
            const double by = (g.albedos[k][c] - source) / std::max(source, floorOf(f.albedos[k]));
            double& kept = (directions[k].z > horizon ? error.albedo : error.lastAlbedo)[c];
            if (std::abs(by) > std::abs(kept)) kept = by;
        }
}

void compareShapes(const SeenBrdf& f, const SeenBrdf& g, PictureError& error) {
    const bool isotropic = f.isotropic && g.isotropic;
    const auto lines = highlightLines(isotropic), ridges = mirrorRidges(isotropic);
    for (std::size_t c = 0; c < error.channels.size(); ++c) {
        const std::string& name = error.channels[c];
        for (std::size_t k = 0; k < lines.size(); ++k) {
            keepDeepest(lines[k], f.line(k), g.line(k), c, name, 1, error.dip);
            keepDeepest(lines[k], f.line(k), g.line(k), c, name, -1, error.peak);
        }
        for (std::size_t k = 0; k < ridges.size(); ++k)
            for (std::size_t i = 0; i < ridges[k].pairs.size(); ++i) {
                const Rgb& source = f.ridge(k)[i];
                const double by =
                    std::abs(g.ridge(k)[i][c] - source[c]) / std::max(source[c], floorOf(source));
                if (by > error.ridge.value) error.ridge = {by, name, ridges[k].pairs[i]};
            }
    }
}

void compareSpheres(const SeenBrdf& f, const SeenBrdf& g, PictureError& error) {
    std::vector<double> flips(f.spheres.size()), colours(f.spheres.size());
    tbb::parallel_for(std::size_t{0}, f.spheres.size(), [&](std::size_t k) {
        std::tie(flips[k], colours[k]) = differences(f.spheres[k], g.spheres[k]);
    });
    error.flip = overLights(flips);
    error.colour = overLights(colours);
}

std::string degreesOf(const Direction& d) {
    const auto tenths = [](double radians) { return std::round(10 * degrees(radians)) / 10 + 0.0; };
    return fmt::format("{:g},{:g}", tenths(polarAngle(d)), tenths(azimuth(d)));
}

/// Shares below this are 0 to people.
constexpr double noShare = 5e-5;

/// "91 % (B, wi 0,0, wo 0,0)"
std::string textOf(const SeenDifference& difference) {
    if (difference.value < noShare) return "0 %";
    return fmt::format("{} ({}, wi {}, wo {})", shareText(difference), difference.channel,
                       degreesOf(difference.at.wi), degreesOf(difference.at.wo));
}

/// "+2 % R, -1 % G, +0 % B"
std::string textOf(const std::vector<double>& shares, const std::vector<std::string>& channels) {
    std::string text;
    for (std::size_t c = 0; c < shares.size(); ++c)
        text += fmt::format("{}{}{}", c == 0 ? "" : ", ",
                            std::abs(shares[c]) < noShare ? "0 %" : signedPercent(shares[c]),
                            channels.size() == 1 ? "" : " " + channels[c]);
    return text;
}

}  // namespace

PictureReference::PictureReference(const Brdf& f) : seen_(std::make_unique<SeenBrdf>(f)) {}
PictureReference::~PictureReference() = default;
PictureReference::PictureReference(PictureReference&&) noexcept = default;

PictureError PictureReference::errorOf(const Brdf& g) const {
    return errorOf(SeenBrdf(g));
}

PictureError PictureReference::errorOfItself() const {
    return errorOf(*seen_);
}

PictureError PictureReference::errorOf(const SeenBrdf& other) const {
    PictureError error{.channels = channelsOf(seen_->grey && other.grey)};
    compareSpheres(*seen_, other, error);
    compareAlbedos(*seen_, other, error);
    compareShapes(*seen_, other, error);
    return error;
}

std::optional<OverLights> PictureReference::flipWithin(const Brdf& g, double most) const {
    const std::vector<PictureLight>& lights = pictureLights();
    std::vector<double> flips(lights.size(), 0.0);
    std::optional<AlbedoTable> table;
    const auto draw = [&](std::size_t k) {
        const SphereOptions options{.rig = lights[k].rig, .size = pixels, .samples = 1};
        flips[k] = sphereFlip(seen_->spheres[k],
                              table ? renderSphere(g, *table, options) : renderSphere(g, options));
    };
    for (const Stage stage : {Stage::points, Stage::discs, Stage::domes}) {
        if (stage == Stage::domes) table.emplace(g, AlbedoTable::Detail::coarse);
        tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t k) {
            if (stageOf(lights[k].rig) == stage) draw(k);
        });
        const double mean =
            std::accumulate(flips.begin(), flips.end(), 0.0) / static_cast<double>(flips.size());
        if (mean > most) return {};
    }
    return overLights(flips);
}

PictureError pictureError(const Brdf& f, const Brdf& g) {
    return PictureReference(f).errorOf(g);
}

std::string shareText(const SeenDifference& difference) {
    return difference.value < noShare ? "0 %" : percentOrTimes(difference.value);
}

std::string summaryOf(const PictureError& error) {
    return fmt::format(
        "FLIP {:.3f}, CIEDE2000 {}, false dip {}, false peak {}, mirror direction off by {}",
        error.flip.mean, significant(error.colour.mean), shareText(error.dip),
        shareText(error.peak), shareText(error.ridge));
}

std::string textOf(const PictureError& error) {
    return fmt::format(
        "albedo off by {} for elevations to 85 degrees\n"
        "colours off by CIEDE2000 {} ({} under the {}), pictures by FLIP {:.3f} ({:.3f} "
        "under the {})\n"
        "highlight: deepest false dip {}, highest false peak {}\n"
        "mirror direction off by {} for elevations to 80 degrees\n"
        "albedo at 89 degrees off by {}\n",
        textOf(error.albedo, error.channels), significant(error.colour.mean),
        significant(error.colour.largest), error.colour.light, error.flip.mean, error.flip.largest,
        error.flip.light, textOf(error.dip), textOf(error.peak), textOf(error.ridge),
        textOf(error.lastAlbedo, error.channels));
}

}  // namespace hshfit::inline pictures
