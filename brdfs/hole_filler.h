#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace hshfit::brdfs {

/// The accuracy of fills: the covered pairs next to holes are predicted as if they were holes, from
/// neighbours at the same places as the neighbours of the hole.
struct FillCheck {
    std::size_t pairs = 0;  ///< covered pairs that were predicted
    /// Relative errors |filled - f| / max(|f|, 1 % of the median f), over pairs and channels.
    double median = 0, percentile95 = 0, largest = 0;
    Direction worstWi = {}, worstWo = {};  ///< of the largest
    /// The scatter of the source: 1.4826 times the median of the same for pairs predicted from
    /// their nearest neighbours, 1 degree away. It includes what f bends over that distance.
    double noise = 0;
    double reach = 0;  ///< median distance of a hole from its nearest neighbour, degrees
};

/// Values for pairs that a BRDF does not cover, from covered pairs with the same half vector: a
/// plane and a paraboloid through asinh(f / (2 s)) (a logarithm beyond s, 0.1 % of the median f)
/// over theta_d (cos phi_d, sin phi_d), by weighted least squares over the rings of neighbours that
/// are nearest, within the range of their values. Holes are therefore continued smoothly from all
/// sides, and blind edges (grazing angles) from one.
class HoleFiller {
public:
    /// `brdf` has to outlive the filler. `progress` is for the check.
    explicit HoleFiller(const Brdf& brdf,
                        const std::function<void(std::size_t, std::size_t)>& progress = {});

    /// Nothing where no pair within 48 degrees of (theta_d, phi_d) is covered.
    std::optional<std::vector<double>> fill(const Direction& wi, const Direction& wo) const;

    /// None if no random pair is a hole that can be filled.
    const std::optional<FillCheck>& check() const { return check_; }

private:
    /// Places of neighbours: ring by ring, the directions around.
    using Places = std::vector<bool>;
    struct Prediction {
        std::vector<double> values;
        Places places;        ///< of the neighbours
        double reach = 0;     ///< degrees, of the nearest neighbour
        double a = 0, b = 0;  ///< its displacement, radians
    };
    /// From neighbours at `only` these places, if there are any.
    std::optional<Prediction> predict(const Direction& wi, const Direction& wo,
                                      const Places& only = {}) const;
    void findScales();
    void measure(const std::function<void(std::size_t, std::size_t)>& progress);

    const Brdf& brdf_;
    std::vector<double> scales_;  ///< s of each channel
    std::optional<FillCheck> check_;
};

}  // namespace hshfit::brdfs
