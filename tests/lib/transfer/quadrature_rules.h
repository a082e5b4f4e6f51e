#pragma once

#include <hshfit/brdf/directions.h>

#include <cmath>
#include <cstddef>
#include <memory>

#include <gsl/gsl_integration.h>

// Brute-force quadrature by rules of GSL, of which only tabulated sizes are good to the last digit.
namespace rules {

/// visit(direction, solid angle) over the sphere or, with nodes in sqrt(cos theta), the hemisphere.
template <class Visit>
void eachPoint(std::size_t rings, std::size_t azimuths, bool sphere, Visit&& visit) {
    const std::unique_ptr<gsl_integration_glfixed_table,
                          decltype(&gsl_integration_glfixed_table_free)>
        table(gsl_integration_glfixed_table_alloc(rings), gsl_integration_glfixed_table_free);
    for (std::size_t r = 0; r < rings; ++r) {
        double at = 0, weight = 0;
        gsl_integration_glfixed_point(sphere ? -1 : 0, 1, r, &at, &weight, table.get());
        const double z = sphere ? at : at * at;
        const double sine = std::sqrt((1 - z) * (1 + z));
        if (!sphere) weight *= 2 * at;
        for (std::size_t j = 0; j < azimuths; ++j) {
            const double phi =
                2 * hshfit::pi * (static_cast<double>(j) + 0.3) / static_cast<double>(azimuths);
            visit(hshfit::Direction{sine * std::cos(phi), sine * std::sin(phi), z},
                  weight * 2 * hshfit::pi / static_cast<double>(azimuths));
        }
    }
}

}  // namespace rules
