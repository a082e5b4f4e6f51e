#include <hshfit/rendering/internal/panel_cells.h>

#include <hshfit/brdf/vectors.h>

#include <algorithm>

namespace hshfit::inline rendering {
namespace {

/// Half of a side of the smallest cells, where half of a panel's side is 1.
constexpr double smallest = 1.0 / 4096;

}  // namespace

PanelCells::PanelCells(std::span<const Light> lights) : rule_(gaussLegendre(nodesAcross)) {
    for (const Light& light : lights) {
        if (const auto* panel = std::get_if<PanelLight>(&light))
            panels_.push_back({PanelPlane(*panel), panel->radiance});
    }
    for (std::size_t k = 0; k < panels_.size(); ++k) coarse_.push_back(cellAt(k, 0, 0, 1));
}

PanelCell PanelCells::cellAt(std::size_t panel, double x, double y, double half) const {
    const PanelPlane& plane = panels_[panel].plane;
    const auto corner = [&](double a, double b) {
        return plane.at(x + a * half, y + b * half).direction;
    };
    return {panel,
            x,
            y,
            half,
            plane.at(x, y).direction,
            std::max(angleBetween(corner(-1, -1), corner(1, 1)),
                     angleBetween(corner(-1, 1), corner(1, -1)))};
}

std::size_t PanelCells::split(const PanelCell& cell, std::array<PanelCell, 4>& parts) const {
    const double half = cell.half / 2;
    if (half < smallest) return 0;
    for (std::size_t k = 0; k < 4; ++k)
        parts[k] = cellAt(cell.panel, cell.x + (k % 2 == 0 ? -half : half),
                          cell.y + (k < 2 ? -half : half), half);
    return 4;
}

void PanelCells::nodesOf(const PanelCell& cell, const Node& node) const {
    const Panel& panel = panels_[cell.panel];
    for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
        for (std::size_t j = 0; j < rule_.nodes.size(); ++j) {
            const PanelPlane::Point point = panel.plane.at(cell.x + cell.half * rule_.nodes[i],
                                                           cell.y + cell.half * rule_.nodes[j]);
            const double weight =
                rule_.weights[i] * rule_.weights[j] * cell.half * cell.half * point.solidAngle;
            node(point.direction, {weight * panel.radiance[0], weight * panel.radiance[1],
                                   weight * panel.radiance[2]});
        }
    }
}

}  // namespace hshfit::inline rendering
