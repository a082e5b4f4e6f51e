#include "sheen_colour.h"

#include <hshfit/linear_algebra/descend.h>

#include <brdfs/analytic/gltf_pbr.h>
#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/picture_samples.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::jobs {
namespace {

using Colours = std::array<double, 6>;  // base R, G, B; sheen R, G, B

std::array<double, 3> channelsOf(const Parameters& p, std::string_view name) {
    const std::vector<double> values = p.colour(name);
    return {values.front(), values[values.size() / 2], values.back()};
}

Parameters withColours(Parameters p, const Colours& colours) {
    p.set("baseColorFactor", {colours[0], colours[1], colours[2]});
    p.set("sheenColorFactor", {colours[3], colours[4], colours[5]});
    const brdfs::Model& model = brdfs::gltfPbrModel();
    return completed(model.name, model.parameters, std::move(p));
}

double lossOf(const Parameters& p, const brdfs::FitSamples& samples) {
    return brdfs::lossOf(*brdfs::gltfPbrModel().make(p), samples, brdfs::Loss::Kind::picture);
}

/// The colours of the least loss.
Colours searched(const Parameters& p, const Colours& colours, const brdfs::FitSamples& samples) {
    std::vector<double> x(colours.begin(), colours.end());
    std::vector<SearchAxis> axes;
    for (const double channel : colours) axes.push_back({std::max(0.05, 0.5 * channel), 0, 1});
    Colours own = colours;
    descend(
        [&](const std::vector<double>& moved) {
            std::ranges::copy(moved, own.begin());
            return lossOf(withColours(p, own), samples);
        },
        x, axes);
    std::ranges::copy(x, own.begin());
    return own;
}

}  // namespace

std::string withColouredSheen(const std::string& spec, const Brdf& source) {
    constexpr double leastGain = 0.02;  // as PartOptions::leastGain
    const brdfs::Model& model = brdfs::gltfPbrModel();
    const Parameters stated =
        readParameters(model.name, model.parameters,
                       std::string_view(spec).substr(std::min(spec.size(), model.name.size() + 1)));
    const Parameters p = completed(model.name, model.parameters, stated);
    const auto base = channelsOf(p, "baseColorFactor"), sheen = channelsOf(p, "sheenColorFactor");
    if (!(*std::ranges::max_element(sheen) > 0) || source.channels().kind != Channels::Kind::rgb ||
        brdfs::areMeasured(source))
        return spec;
    const brdfs::FitSamples samples = brdfs::pictureSamples(source);
    const Parameters coloured = withColours(
        stated, searched(stated, {base[0], base[1], base[2], sheen[0], sheen[1], sheen[2]},
                         samples.fewer ? *samples.fewer : samples));
    if (lossOf(coloured, samples) > (1 - leastGain) * lossOf(p, samples)) return spec;
    return fmt::format("{}:{}", model.name, coloured.canonical());
}

}  // namespace hshfit::jobs
