#include <hshfit/pictures/internal/channel_colours.h>

#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>

#include <fmt/format.h>

namespace hshfit::inline pictures {

ChannelColours::ChannelColours(const Channels& channels) {
    switch (channels.kind) {
        case Channels::Kind::grey:
            weights_ = {{{1}, {1}, {1}}};
            what_ = "one value for every colour";
            grey_ = true;
            return;
        case Channels::Kind::rgb:
            weights_ = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
            what_ = "linear Rec. 709";
            return;
        case Channels::Kind::named:
            throw UsageError(
                fmt::format("{} is no reflectance and has no picture", channels.names().back()));
        case Channels::Kind::spectral:
            break;
    }
    try {
        weights_ = rgbWeights(channels.wavelengths).weights;
        what_ = fmt::format("{} wavelengths, CIE 1931 2 degrees, D65", channels.count());
    } catch (const UsageError&) {
        const std::vector<double> equal(channels.count(),
                                        1 / static_cast<double>(channels.count()));
        weights_ = {equal, equal, equal};
        what_ = fmt::format("mean of {} wavelengths, which make no colour", channels.count());
        grey_ = true;
    }
}

}  // namespace hshfit::inline pictures
