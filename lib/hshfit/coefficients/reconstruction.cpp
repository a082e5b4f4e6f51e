#include <hshfit/coefficients/reconstruction.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline coefficients {

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
    std::vector<double> x(wi.count), y(wi.count);
    for (std::size_t k = 0; k < wi.count; ++k) {
        const Direction turned = rotateAboutZ({wi.x[k], wi.y[k], wi.z[k]}, -found.turn);
        x[k] = turned.x;
        y[k] = turned.y;
    }
    if (!(wo.z > 0)) std::fill(c.begin(), c.end(), 0.0);
    synthesise(*basis_, c, {x.data(), y.data(), wi.z, wi.count}, out);
}

void Reconstruction::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    evalQuantity(wo, wi, out);
    if (coefficients_.quantity == Quantity::brdfCosine) {
        divideByCosine(wi, coefficients_.channels.count(), out);
    }
}

namespace {

/// Sums over i of c_i columns[i * count + k], for each k in the order of i.
void addColumns(std::span<const double> c, const double* columns, std::size_t count, double* out) {
    if (count == 1) {
        double sum = 0;
        for (std::size_t i = 0; i < c.size(); ++i) sum += c[i] * columns[i];
        *out = sum;
        return;
    }
    std::fill_n(out, count, 0.0);
    // Four columns for each reading and writing of `out`, which is half of the time otherwise.
    std::size_t i = 0;
    for (; i + 4 <= c.size(); i += 4) {
        const double* const a = columns + i * count;
        const double* const b = a + count;
        const double* const d = b + count;
        const double* const e = d + count;
        for (std::size_t k = 0; k < count; ++k) {
            out[k] = out[k] + c[i] * a[k] + c[i + 1] * b[k] + c[i + 2] * d[k] + c[i + 3] * e[k];
        }
    }
    for (; i < c.size(); ++i) {
        const double* const column = columns + i * count;
        for (std::size_t k = 0; k < count; ++k) out[k] += c[i] * column[k];
    }
}

}  // namespace

void synthesise(const Basis& basis, std::span<const double> c, DirectionBatch wi, double* out) {
    const std::size_t slots = basis.slots(), channels = c.size() / slots;
    // Blocks keep the basis values in cache whatever the order.
    const std::size_t block = std::min(std::clamp<std::size_t>(65536 / slots, 1, 256),
                                       std::max<std::size_t>(1, wi.count));
    std::vector<double> values(block * slots);
    for (std::size_t first = 0; first < wi.count; first += block) {
        const std::size_t count = std::min(block, wi.count - first);
        basis.evaluateColumns({wi.x + first, wi.y + first, wi.z + first, count}, values.data());
        for (std::size_t channel = 0; channel < channels; ++channel) {
            double* const to = out + channel * wi.count + first;
            addColumns(c.subspan(channel * slots, slots), values.data(), count, to);
            for (std::size_t k = 0; k < count; ++k)
                if (!(wi.z[first + k] > 0)) to[k] = 0;
        }
    }
}

void divideByCosine(DirectionBatch wi, std::size_t channels, double* values) {
    for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t k = 0; k < wi.count; ++k) {
            if (wi.z[k] > 0) values[c * wi.count + k] /= wi.z[k];
        }
    }
}

}  // namespace hshfit::inline coefficients
