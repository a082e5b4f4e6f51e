#include <hshfit/reconstruction.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>

#include <algorithm>
#include <cmath>

namespace hshfit {

Reconstruction::Reconstruction(Coefficients coefficients) : coefficients_(std::move(coefficients)) {
    try {
        basis_ = bases::make(coefficients_.basis, coefficients_.order,
                             {.condonShortley = coefficients_.condonShortley});
    } catch (const UsageError& error) {
        throw InputError(std::string("coefficients of ") + coefficients_.source + ": " +
                         error.what());
    }
    laws_.isotropic = coefficients_.isotropic;
    laws_.mirrorSymmetric = coefficients_.bilateral;
}

void Reconstruction::evalQuantity(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t slots = coefficients_.slots(), channels = coefficients_.channels.count();
    const OutgoingLookup found = lookUp(coefficients_.outgoing, wo);
    std::vector<double> c(channels * slots, 0.0);
    for (int k = 0; k < found.count; ++k) {
        const double* from = coefficients_.at(found.index[k], 0);
        for (std::size_t i = 0; i < c.size(); ++i) c[i] += found.weight[k] * from[i];
    }
    // Blocks keep the basis values in cache whatever the order.
    const std::size_t block = std::clamp<std::size_t>(65536 / slots, 1, 256);
    std::vector<double> values(block * slots), x(block), y(block);
    for (std::size_t first = 0; first < wi.count; first += block) {
        const std::size_t count = std::min(block, wi.count - first);
        for (std::size_t k = 0; k < count; ++k) {
            const Direction turned =
                rotateAboutZ({wi.x[first + k], wi.y[first + k], wi.z[first + k]}, -found.turn);
            x[k] = turned.x;
            y[k] = turned.y;
        }
        basis_->evaluate({x.data(), y.data(), wi.z + first, count}, values.data());
        for (std::size_t k = 0; k < count; ++k) {
            const bool above = wi.z[first + k] > 0 && wo.z > 0;
            for (std::size_t channel = 0; channel < channels; ++channel) {
                double sum = 0;
                const double* row = values.data() + k * slots;
                for (std::size_t i = 0; i < slots; ++i) sum += c[channel * slots + i] * row[i];
                out[channel * wi.count + first + k] = above ? sum : 0;
            }
        }
    }
}

void Reconstruction::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    evalQuantity(wo, wi, out);
    if (coefficients_.quantity == Quantity::brdf) return;
    for (std::size_t c = 0; c < coefficients_.channels.count(); ++c) {
        for (std::size_t k = 0; k < wi.count; ++k) {
            if (wi.z[k] > 0) out[c * wi.count + k] /= wi.z[k];
        }
    }
}

}  // namespace hshfit
