#include <hshfit/projection/albedo.h>

#include <hshfit/error.h>
#include <hshfit/projection/internal/rings.h>
#include <hshfit/stop_request.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace hshfit::inline projection {

AlbedoEstimate estimateAlbedo(const Brdf& brdf, const Direction& wo, const AlbedoOptions& options) {
    const std::vector<Lobe> lobes = brdf.lobes(wo);
    const std::vector<double> kinks = brdf.kinks(wo);
    AlbedoEstimate result;
    result.error = std::numeric_limits<double>::infinity();
    double before = result.error;  // relative changes
    const AzimuthTables azimuths(1);
    RingSpectrum spectrum;
    for (int level = 0; !result.converged; ++level) {
        stopIfRequested();
        const HemisphereGrid grid =
            gridFor(lobes, wo, {.order = 1, .level = level, .squeezed = true}, kinks);
        if (result.evaluations + grid.points() > options.maxEvaluations) break;
        result.evaluations += grid.points();
        sampleRings(brdf, wo, grid, Quantity::brdfCosine, azimuths, /*even=*/false, spectrum);
        std::vector<double> albedo(spectrum.channels, 0.0);
        double change = 0, scale = 1;
        for (std::size_t c = 0; c < spectrum.channels; ++c) {
            for (std::size_t r = 0; r < spectrum.rings; ++r) {
                albedo[c] += grid.weights[r] * spectrum.part(r, c, 0) * std::sqrt(2 * pi);
            }
            if (level > 0) change = std::max(change, std::abs(albedo[c] - result.values[c]));
            scale = std::max(scale, std::abs(albedo[c]));
        }
        result.values = std::move(albedo);
        if (level == 0) continue;
        // Twice in a row: two levels may agree by accident where f has steps. Once is enough where
        // changes fall fast.
        constexpr double fast = 0.1;
        const double tolerance = options.tolerance;
        result.error = change;
        result.converged = change <= scale * tolerance * (before <= tolerance ? 1 : fast);
        before = change / scale;
    }
    return result;
}

std::vector<double> directionalAlbedo(const Brdf& brdf, const Direction& wo, double tolerance) {
    AlbedoEstimate found = estimateAlbedo(brdf, wo, {.tolerance = tolerance});
    if (found.converged) return std::move(found.values);
    throw NumericError(fmt::format("{}: the albedo at theta_o = {:.6g} degrees did not converge",
                                   brdf.name(), degrees(polarAngle(wo))));
}

}  // namespace hshfit::inline projection
