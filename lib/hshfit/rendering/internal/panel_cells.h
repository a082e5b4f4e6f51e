#pragma once

#include <hshfit/light/light_samples.h>
#include <hshfit/light/panel_plane.h>
#include <hshfit/quadrature/quadrature.h>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline rendering {

/// A rectangle of a panel, in the coordinates of its plane.
struct PanelCell {
    std::size_t panel = 0;
    double x = 0, y = 0, half = 1;  ///< the middle, and half of a side
    Direction direction = {};       ///< of the middle, in the world
    double width = 0;               ///< the angle between opposite corners, radians
};

/// Panels as trees of cells: each is cut into four.
class PanelCells {
public:
    /// Gauss nodes of a cell along each side.
    static constexpr int nodesAcross = 3;

    /// Other lights than panels are left out.
    explicit PanelCells(std::span<const Light> lights);

    /// One cell for each panel.
    const std::vector<PanelCell>& coarse() const { return coarse_; }

    /// Writes the parts of a cell, and returns their number: 0 for a cell that is not cut.
    std::size_t split(const PanelCell& cell, std::array<PanelCell, 4>& parts) const;

    using Node = std::function<void(const Direction& world, const Rgb& flux)>;
    void nodesOf(const PanelCell& cell, const Node& node) const;

private:
    PanelCell cellAt(std::size_t panel, double x, double y, double half) const;

    struct Panel {
        PanelPlane plane;
        Rgb radiance;
    };
    const GaussRule& rule_;
    std::vector<Panel> panels_;
    std::vector<PanelCell> coarse_;
};

}  // namespace hshfit::inline rendering
