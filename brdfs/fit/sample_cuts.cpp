#include <brdfs/fit/sample_cuts.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr double oneElevation = 0.5, oneAzimuth = 1, inPlane = 1;  ///< degrees
constexpr double atNormal = 0.25;  ///< degrees: every plane holds a direction this near the normal
constexpr std::size_t fewest = 3, mostPanels = 6;

Direction incomingOf(const FitSamples& samples, std::size_t k) {
    return {samples.wiX[k], samples.wiY[k], samples.wiZ[k]};
}

/// A sample as seen from its fixed direction, in degrees.
struct Seen {
    std::size_t sample;
    double theta, azimuth;
    double angle;    ///< of the other direction, towards the mirror direction
    double outside;  ///< of the plane
};

Seen seenFrom(const Direction& fixed, const Direction& moving, bool isotropic, std::size_t sample) {
    Seen seen{sample, degrees(polarAngle(fixed)), degrees(azimuth(fixed)), 0, 0};
    if (seen.theta < atNormal) {
        // Isotropic data have one curve in all planes; a sign tells their two sides apart.
        seen.azimuth = 180;
        const double side = moving.x < 0 || (moving.x == 0 && moving.y < 0) ? -1 : 1;
        seen.angle = side * degrees(polarAngle(moving));
        if (!isotropic) seen.outside = degrees(std::asin(std::clamp(std::abs(moving.y), 0.0, 1.0)));
        return seen;
    }
    const double horizontal = std::hypot(fixed.x, fixed.y);
    const double x = -fixed.x / horizontal, y = -fixed.y / horizontal;
    const double along = moving.x * x + moving.y * y, across = moving.y * x - moving.x * y;
    seen.angle = degrees(std::atan2(along, moving.z));
    seen.outside = degrees(std::asin(std::clamp(std::abs(across), 0.0, 1.0)));
    if (isotropic) seen.azimuth = 180;
    return seen;
}

/// Runs of sorted values none of which is further than `width` from the first of its run.
template <class Value>
std::vector<std::vector<Seen>> runsOf(std::vector<Seen> all, double width, const Value& value) {
    std::ranges::stable_sort(all, {}, value);
    std::vector<std::vector<Seen>> runs;
    for (const Seen& seen : all) {
        if (runs.empty() || value(seen) > value(runs.back().front()) + width) runs.emplace_back();
        runs.back().push_back(seen);
    }
    return runs;
}

SampleCut cutOf(std::vector<Seen> seen) {
    std::ranges::stable_sort(seen, {}, &Seen::angle);
    SampleCut cut;
    const auto count = static_cast<double>(seen.size());
    for (const Seen& one : seen) {
        cut.theta += one.theta / count;
        cut.azimuth += one.azimuth / count;
        cut.samples.push_back(one.sample);
        cut.angles.push_back(one.angle);
    }
    return cut;
}

SampleCuts cutsOf(const FitSamples& samples, SampleCuts::Of of) {
    std::vector<Seen> seen;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Direction wi = incomingOf(samples, k), &wo = samples.wo[k];
        Seen one = of == SampleCuts::Of::outgoing ? seenFrom(wo, wi, samples.isotropic, k)
                                                  : seenFrom(wi, wo, samples.isotropic, k);
        if (of == SampleCuts::Of::retro) {
            if (degrees(angleBetween(wi, wo)) > inPlane) continue;
            one = {k, 0, 0, degrees(polarAngle(wi)), 0};
        }
        if (one.outside <= inPlane) seen.push_back(one);
    }
    SampleCuts result{.of = of, .cuts = {}};
    for (const auto& elevation :
         runsOf(std::move(seen), oneElevation, [](const Seen& s) { return s.theta; }))
        for (auto& run : runsOf(elevation, oneAzimuth, [](const Seen& s) { return s.azimuth; })) {
            if (run.size() < fewest) continue;
            result.inPlane += run.size();
            result.cuts.push_back(cutOf(std::move(run)));
        }
    return result;
}

/// The elevations of "15,45"; none for a word.
std::optional<std::vector<double>> elevationsIn(const std::string& panels) {
    if (panels == "auto" || panels == "all") return std::nullopt;
    std::vector<double> elevations;
    for (std::size_t first = 0; first <= panels.size();) {
        const std::size_t last = std::min(panels.find(',', first), panels.size());
        double angle = 0;
        const auto parsed = std::from_chars(panels.data() + first, panels.data() + last, angle);
        if (parsed.ec != std::errc() || parsed.ptr != panels.data() + last ||
            !(angle >= 0 && angle <= 90))
            throw UsageError(
                fmt::format("the panels of a figure are auto, all, or elevations from "
                            "0 to 90 degrees with commas (15,45), not '{}'",
                            panels));
        elevations.push_back(angle);
        first = last + 1;
    }
    return elevations;
}

}  // namespace

DirectionPair SampleCuts::pairAt(const SampleCut& cut, double angle) const {
    const double phi = radians(cut.azimuth);
    const Direction moving = directionFromAngles(radians(-angle), phi);
    if (of == Of::retro) return {moving, moving};
    const Direction fixed = directionFromAngles(radians(cut.theta), phi);
    return of == Of::incidence ? DirectionPair{fixed, moving} : DirectionPair{moving, fixed};
}

SampleCuts cutsOf(const FitSamples& samples) {
    if (samples.sums) return {};
    SampleCuts incidence = cutsOf(samples, SampleCuts::Of::incidence),
               outgoing = cutsOf(samples, SampleCuts::Of::outgoing);
    // The more samples in cuts the better, then the fewer cuts.
    const auto rank = [](const SampleCuts& cuts) {
        return std::pair{cuts.inPlane, -static_cast<double>(cuts.cuts.size())};
    };
    SampleCuts best = rank(outgoing) > rank(incidence) ? std::move(outgoing) : std::move(incidence);
    return best.cuts.empty() ? cutsOf(samples, SampleCuts::Of::retro) : best;
}

void checkPanels(const std::string& panels) {
    elevationsIn(panels);
}

SampleCuts chosenCuts(SampleCuts cuts, const std::string& panels) {
    const auto elevations = elevationsIn(panels);
    if (panels == "all" || (!elevations && cuts.cuts.size() <= mostPanels)) return cuts;
    std::vector<SampleCut> chosen;
    if (!elevations) {
        for (std::size_t k = 0; k < mostPanels; ++k)
            chosen.push_back(std::move(cuts.cuts[k * (cuts.cuts.size() - 1) / (mostPanels - 1)]));
    } else {
        for (const double angle : *elevations) {
            const auto nearest = std::ranges::min_element(
                cuts.cuts, {}, [&](const SampleCut& c) { return std::abs(c.theta - angle); });
            if (nearest == cuts.cuts.end() || std::abs(nearest->theta - angle) > 1) {
                std::vector<std::string> there;
                for (const SampleCut& cut : cuts.cuts)
                    there.push_back(fmt::format("{:.3g}", cut.theta));
                there.erase(std::unique(there.begin(), there.end()), there.end());
                throw UsageError(fmt::format(
                    "no cut in a plane of incidence has an elevation of {:g} degrees; "
                    "those measured: {}",
                    angle, there.empty() ? "none" : fmt::format("{}", fmt::join(there, ", "))));
            }
            for (const SampleCut& cut : cuts.cuts)
                if (std::abs(cut.theta - nearest->theta) < oneElevation) chosen.push_back(cut);
        }
    }
    cuts.cuts = std::move(chosen);
    return cuts;
}

}  // namespace hshfit::brdfs
