#pragma once

#include <jobs/common/listener.h>
#include "channel_rows.h"
#include "description.h"

#include <hshfit/brdf/directions.h>
#include <hshfit/material_maps/processes.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The frame of a texel relative to the frame of the surface: its normal of length 1, and the
/// azimuth of the direction that its model calls x, radians.
struct TexelTurn {
    Direction normal = {0, 0, 1};
    double azimuth = 0;
};

/// Maps of normals and of directions, opened and read once: normals have a length of 1 within 5 %
/// (others are counted where the description renormalises, else refused) and z above 0.
class TurnMaps {
public:
    /// `checkSize` is called with each picture, as it is opened. Throws InputError that names the
    /// file and the texel.
    TurnMaps(const MaterialDescription& description,
             const std::function<void(const PictureFile&)>& checkSize);
    /// Reads some rows.
    void check(const ItemRange& rows, const Listener& listener);

    /// Whether the description turns texels at all.
    bool any() const { return normals_ || directions_ || azimuth_ != 0; }
    bool hasNormals() const { return normals_ != nullptr; }
    bool hasDirections() const { return directions_ || azimuth_ != 0; }
    bool hasMaps() const { return normals_ || directions_; }
    /// Normals in the rows of `check` whose length is off by more than 5 %.
    std::size_t renormalised() const { return renormalised_; }

    /// A row of `width` texels. By one thread at a time; best with rising rows.
    std::vector<TexelTurn> row(std::size_t row, std::size_t width);
    void checkIntact() const;

private:
    void addNormals(std::size_t row, std::vector<TexelTurn>& turns);
    void addDirections(std::size_t row, std::vector<TexelTurn>& turns);

    NormalReference normal_ = {};
    DirectionReference direction_ = {};
    std::unique_ptr<ChannelRows> normals_, directions_;
    double azimuth_ = 0;  ///< of a constant direction
    std::size_t renormalised_ = 0;
};

}  // namespace hshfit::jobs
