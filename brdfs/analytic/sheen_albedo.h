#pragma once

#include <array>
#include <cstddef>

namespace hshfit::brdfs {

/// Directional albedo E of charlie's lobe (charlie.h) with r = roughness^2, cut at 1, which it
/// exceeds towards grazing angles. Tabulated once at 25 values of the roughness from
/// `leastRoughness` to 1 and 65 of sqrt(cos theta), by Gauss-Legendre and midpoint rules;
/// cubics between them.
class SheenAlbedoTable {
public:
    static constexpr double leastRoughness = 0.1;
    static constexpr int roughnesses = 25, steps = 64;
    /// At sqrt(cos) = k / steps for k = -1 .. steps + 1, the ends extrapolated.
    using Row = std::array<double, steps + 3>;

    static const SheenAlbedoTable& instance();
    /// E of one roughness, and its derivative by it.
    void at(double roughness, Row& values, Row& slopes) const;

private:
    SheenAlbedoTable();
    std::array<Row, roughnesses + 2> rows_;  ///< one more at either end
};

}  // namespace hshfit::brdfs
