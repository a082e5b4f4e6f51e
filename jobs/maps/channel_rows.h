#pragma once

#include <hshfit/picture_files/picture_file.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Some channels of a picture, row by row, with the rows that were read last.
class ChannelRows {
public:
    /// `channels` by name. Without any, takes `otherwise` if the picture has the first of these,
    /// else the picture's first channel. Throws InputError for a channel that the picture lacks.
    ChannelRows(const std::string& path, const std::vector<std::string>& channels,
                const std::vector<std::string>& otherwise);

    const PictureFile& picture() const { return picture_; }
    std::size_t channels() const { return indices_.size(); }
    /// out[channel][column], values as stored. By one thread at a time; best with rising rows.
    void row(std::size_t row, float* out);

private:
    int find(const std::string& name) const;

    PictureFile picture_;
    std::vector<int> indices_;
    int first_ = 0, last_ = 0;
    std::size_t top_ = 0, bottom_ = 0;
    std::vector<float> block_;
};

}  // namespace hshfit::jobs
