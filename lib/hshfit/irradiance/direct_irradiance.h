#pragma once

#include <hshfit/light/lights.h>

#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline irradiance {

/// Irradiance of a surface in the light, without coefficients:
///     E(n) = integral of L(w) max(0, n . w) d omega.
/// Pictures: n times the vector integrals of L w d omega over columns, or blocks, of pixels that
/// lie above the horizon, exact for latitude-longitude pictures; on the horizon pixel by pixel,
/// which count with their centre of flux (relative error about a quarter of the squared angle of a
/// pixel); pictures of less than 1024 columns are divided until they have as many. Discs, panels
/// and skies by the nodes of light_nodes.h. Safe to use from many threads.
class DirectIrradiance {
public:
    /// The lights have to outlive it.
    explicit DirectIrradiance(std::span<const Light> lights);
    ~DirectIrradiance();
    DirectIrradiance(const DirectIrradiance&) = delete;
    DirectIrradiance& operator=(const DirectIrradiance&) = delete;

    Rgb at(const Direction& normal) const;

private:
    class Picture;
    class Columns;
    class Blocks;
    std::vector<std::unique_ptr<PictureLight>> fine_;  ///< of small pictures
    std::vector<std::unique_ptr<Picture>> pictures_;
    std::vector<const Light*> others_;
};

}  // namespace hshfit::inline irradiance
