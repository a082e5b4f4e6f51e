#include <hshfit/projection/albedo.h>

#include <hshfit/error.h>
#include <hshfit/projection/internal/rings.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace hshfit::inline projection {

std::vector<double> directionalAlbedo(const Brdf& brdf, const Direction& wo, double tolerance) {
    constexpr std::size_t maxEvaluations = std::size_t{1} << 26;
    const std::vector<Lobe> lobes = brdf.lobes(wo);
    std::vector<double> previous;
    double before = std::numeric_limits<double>::infinity();
    std::size_t evaluations = 0;
    const AzimuthTables azimuths(1);
    RingSpectrum spectrum;
    for (int level = 0;; ++level) {
        const HemisphereGrid grid =
            gridFor(lobes, wo, {.order = 1, .level = level, .squeezed = true}, brdf.kinks(wo));
        evaluations += grid.points();
        if (evaluations > maxEvaluations) break;
        sampleRings(brdf, wo, grid, Quantity::brdfCosine, azimuths, /*even=*/false, spectrum);
        std::vector<double> albedo(spectrum.channels, 0.0);
        double change = 0;
        for (std::size_t c = 0; c < spectrum.channels; ++c) {
            for (std::size_t r = 0; r < spectrum.rings; ++r) {
                albedo[c] += grid.weights[r] * spectrum.part(r, c, 0) * std::sqrt(2 * pi);
            }
            if (level > 0) change = std::max(change, std::abs(albedo[c] - previous[c]));
        }
        // Twice in a row: two levels may agree by accident where f has steps. Once is enough where
        // changes fall fast.
        constexpr double fast = 0.1;
        if (level > 0 && change <= tolerance * (before <= tolerance ? 1 : fast)) return albedo;
        if (level > 0) before = change;
        previous = std::move(albedo);
    }
    throw NumericError(fmt::format("{}: the albedo at theta_o = {:.6g} degrees did not converge",
                                   brdf.name(), degrees(polarAngle(wo))));
}

}  // namespace hshfit::inline projection
