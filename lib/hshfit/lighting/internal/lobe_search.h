#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/lighting/prefilter.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::lighting {

/// The square of a band's weight: 100 for the albedo, 0.3 / l for the others.
double bandWeight(int l);

struct LobePlace {
    Direction axis;
    double roughness = 1;
};

/// f cos(theta_i) of one wo in spherical harmonics, with what the search asks of it.
class LobeTarget {
public:
    LobeTarget(const Basis& basis, std::array<std::vector<double>, 3> f);

    /// [l]: the sums over m of f_{l,m} Y_{l,m}(axis), by channel; the fourth is 0.
    std::vector<Eigen::Array4d> along(const Direction& axis) const;
    /// The sum of squares with the weights of bands, over channels.
    double size() const { return size_; }
    /// The coefficients less the coefficients of lobes: [channel][slot].
    std::array<std::vector<double>, 3> without(const std::vector<Direction>& axes,
                                               const std::vector<std::vector<double>>& bands,
                                               const std::vector<Rgb>& scales) const;
    const std::array<std::vector<double>, 3>& coefficients() const { return f_; }

private:
    const Basis* basis_;
    std::array<std::vector<double>, 3> f_;
    std::vector<Eigen::Array4d> bySlot_;  ///< f_ and a 0
    double size_ = 0;
};

/// The lobes of one row with their scales; `left` is the root of the share of the weighted squares
/// that they leave.
struct LobeSolution {
    std::vector<LobePlace> places;
    std::vector<Rgb> scales;
    Rgb diffuse{};
    double left = 0;
};

/// Squares of f cos(theta_i), and of what lobes leave of it, by [channel * bands + l]: sums over m.
struct BandSquares {
    std::vector<double> whole, left;
};

/// Finds lobes of a prefiltered environment that add up to a target (prefiltered_lobes.h). A
/// kernel between two levels is a mixture of both, so that all products with a lobe on an axis are
/// linear in its share, and only axes have to be searched.
class LobeSearch {
public:
    LobeSearch(int bands, const Prefilter& engine, std::size_t lobes, bool inPlane);

    /// A search without a start: one lobe after the other from a grid of axes, each again with the
    /// others fixed, then between the grid's axes.
    LobeSolution free(const LobeTarget& target, double theta) const;
    /// A search that starts from the lobes of a row beside it, whose theta is `before`. Lobes move
    /// at most 0.1 in roughness and, about the mirror direction, 12 degrees; `reach` is the share
    /// of these bounds that is allowed.
    LobeSolution continued(const LobeTarget& target, double theta,
                           std::span<const LobePlace> places, double before,
                           double reach = 1) const;
    /// The root of the share of the weighted squares, without the albedo's, that lobes leave with
    /// their scales as they are.
    double leftBy(const LobeTarget& target, const LobeSolution& solution) const;

    BandSquares squares(const LobeTarget& target, const LobeSolution& solution) const;

private:
    class Row;
    double selfProduct(std::size_t a, std::size_t b) const;

    int bands_;
    const Prefilter* engine_;
    std::size_t lobes_;
    bool inPlane_;
    std::vector<std::vector<double>> levels_;  ///< kernelBands of each level
    std::vector<double> selfProducts_;         ///< of level j with itself and with j - 1
    std::vector<Direction> axes_;              ///< the grid
};

}  // namespace hshfit::lighting
