#include <hshfit/light/environment_matrix.h>

#include <hshfit/bases/sh.h>
#include <hshfit/rotation/basis_change.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr double smallestElement = 1e-9;

}  // namespace

std::vector<EnvironmentElement> environmentMatrix(const Basis& basis, int environmentOrder,
                                                  Quantity quantity) {
    const auto harmonics =
        bases::makeSh(environmentOrder, {.condonShortley = basis.condonShortley()});
    const BasisChange change(
        basis, *harmonics,
        quantity == Quantity::brdf ? Basis::Inner::projectedSolidAngle : Basis::Inner::solidAngle);
    std::vector<EnvironmentElement> elements;
    for (int m = 0; m < std::min(basis.order(), environmentOrder); ++m) {
        const std::vector<double> block = change.block(m);
        for (int j = m, at = 0; j < environmentOrder; ++j) {
            for (int l = m; l < basis.order(); ++l, ++at) {
                const double value = block[static_cast<std::size_t>(at)];
                if (std::abs(value) < smallestElement) continue;
                elements.push_back({slotOf(l, m), slotOf(j, m), value});
                if (m > 0) elements.push_back({slotOf(l, -m), slotOf(j, -m), value});
            }
        }
    }
    std::ranges::sort(elements, {},
                      [](const EnvironmentElement& e) { return std::pair(e.slot, e.environment); });
    return elements;
}

}  // namespace hshfit::inline light
