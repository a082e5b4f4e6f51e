#pragma once

#include <hshfit/light/picture_layout.h>

#include <span>
#include <vector>

namespace hshfit::inline light {

/// Takes the rows of a picture in their order and keeps them, or box-filtered ones where there are
/// more pixels than `most`: a kept pixel is the mean of the pixels that it covers, by their solid
/// angles and the parts of them that it covers. Faces of cubes do not mix. Memory: the kept pixels
/// and two of their rows.
class PictureReduction {
public:
    PictureReduction(const PictureGeometry& file, std::size_t most);

    const PictureGeometry& geometry() const { return kept_; }
    void add(std::size_t row, std::span<const float> rgb);
    std::vector<float> result() { return std::move(rgb_); }

private:
    struct Overlap {
        std::size_t column;  ///< the kept column on the left
        double share;        ///< of the file's column in it; the rest is in the next
    };
    void addTo(std::size_t keptRow, double share, std::size_t row, std::span<const float> rgb);
    void finish(std::size_t keptRow);

    PictureGeometry file_, kept_;
    std::vector<float> rgb_;
    std::vector<Overlap> overlaps_;
    std::vector<double> sums_;  ///< [column][R, G, B, weight] of the row in progress
    std::size_t inProgress_ = 0;
};

/// Solid angle of a pixel from its middle alone, times any constant of the layout.
double middleWeight(const PictureGeometry& geometry, std::size_t column, std::size_t row);

}  // namespace hshfit::inline light
