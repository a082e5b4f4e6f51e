#pragma once

#include <hshfit/brdf/channels.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// The R, G and B, linear Rec. 709, of values per channel, in every picture of a BRDF: a grey
/// value is all three; spectra become RGB as in colour.h; spectra with too few wavelengths become
/// their mean, as grey.
class ChannelColours {
public:
    explicit ChannelColours(const Channels& channels);

    /// R, G and B of values[0], values[stride], …, one for each channel. Not clamped.
    std::array<double, 3> operator()(const double* values, std::size_t stride = 1) const {
        std::array<double, 3> rgb{};
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < weights_[c].size(); ++i)
                rgb[c] += weights_[c][i] * values[i * stride];
        return rgb;
    }
    /// The conversion in words.
    const std::string& what() const { return what_; }
    /// R, G and B are the same for all values.
    bool grey() const { return grey_; }

private:
    std::array<std::vector<double>, 3> weights_;
    std::string what_;
    bool grey_ = false;
};

}  // namespace hshfit::inline pictures
