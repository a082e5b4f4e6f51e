#include "channel_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hshfit::jobs {

ChannelRows::ChannelRows(const std::string& path, const std::vector<std::string>& channels,
                         const std::vector<std::string>& otherwise)
    : picture_(path) {
    const bool has = !otherwise.empty() && picture_.find(otherwise.front()) >= 0;
    for (const std::string& name : channels.empty() && has ? otherwise : channels)
        indices_.push_back(find(name));
    if (indices_.empty()) indices_.push_back(0);
    first_ = *std::ranges::min_element(indices_);
    last_ = *std::ranges::max_element(indices_) + 1;
}

void ChannelRows::row(std::size_t row, float* out) {
    const auto stride = static_cast<std::size_t>(last_ - first_);
    const std::size_t width = picture_.width();
    if (row < top_ || row >= bottom_) {
        const std::size_t rows = picture_.blockRows(stride);
        top_ = row / rows * rows;
        bottom_ = std::min(top_ + rows, picture_.height());
        block_.resize((bottom_ - top_) * width * stride);
        picture_.read(top_, bottom_, first_, last_, block_.data());
    }
    for (std::size_t c = 0; c < channels(); ++c) {
        const float* from = block_.data() + (row - top_) * width * stride +
                            static_cast<std::size_t>(indices_[c] - first_);
        for (std::size_t x = 0; x < width; ++x) out[c * width + x] = from[x * stride];
    }
}

int ChannelRows::find(const std::string& name) const {
    const int index = picture_.find(name);
    if (index < 0) {
        picture_.fail(fmt::format("has no channel {}; channels: {}", name,
                                  fmt::join(picture_.channels(), ", ")));
    }
    return index;
}

}  // namespace hshfit::jobs
