#include <hshfit/light/radiance.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/projection/lane_products.h>
#include <hshfit/representation/basis_matrix.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

/// Light samples evaluated at a time: a batch and its values stay in the cache.
constexpr std::size_t batchSize = 1024;
/// Values of a basis at a time: 256 KiB of double.
constexpr std::size_t keptValues = 32768;

/// Adds the radiance of one batch of f, [channel][k], under the light samples from `first` on.
template <class Real>
void addBatch(const LightSamples& light, std::size_t first, std::size_t count, const Real* f,
              std::size_t channels, Rgb& sum) {
    for (std::size_t c = 0; c < 3; ++c) {
        const Real* values = f + (channels == 1 ? 0 : c) * count;
        for (std::size_t k = 0; k < count; ++k) {
            sum[c] += light.flux[c][first + k] * light.z[first + k] * values[k];
        }
    }
}

Rgb radianceAt(const Brdf& brdf, const LightSamples& light, const Direction& wo) {
    const std::size_t channels = brdf.channels().count();
    std::vector<double> f(channels * batchSize);
    Rgb sum{};
    for (std::size_t first = 0; first < light.count(); first += batchSize) {
        const std::size_t count = std::min(batchSize, light.count() - first);
        brdf.eval(wo, {&light.x[first], &light.y[first], &light.z[first], count}, f.data());
        addBatch(light, first, count, f.data(), channels, sum);
    }
    return sum;
}

Rgb radianceAt(const PairEvaluator& evaluator, std::size_t channels, const LightSamples& light,
               const Direction& wo) {
    std::vector<float> f(channels * batchSize);
    const std::vector<double> x(batchSize, wo.x), y(batchSize, wo.y), z(batchSize, wo.z);
    Rgb sum{};
    for (std::size_t first = 0; first < light.count(); first += batchSize) {
        const std::size_t count = std::min(batchSize, light.count() - first);
        evaluator.evaluate({&light.x[first], &light.y[first], &light.z[first], count},
                           {x.data(), y.data(), z.data(), count}, f.data());
        addBatch(light, first, count, f.data(), channels, sum);
    }
    return sum;
}

Radiance forEachView(const Views& views, const std::function<Rgb(const Direction&)>& radiance) {
    Radiance result(views.size());
    tbb::parallel_for(std::size_t{0}, views.size(),
                      [&](std::size_t v) { result[v] = radiance(views.directions[v]); });
    return result;
}

Radiance fromRows(const Coefficients& rows, const BasisLight& light, const Views& views) {
    const std::size_t size = rows.channels.count() * rows.slots();
    return forEachView(views, [&](const Direction& wo) {
        const OutgoingLookup found = lookUp(rows.outgoing, wo);
        std::vector<double> c(size, 0.0);
        for (std::size_t n = 0; n < static_cast<std::size_t>(found.count); ++n) {
            const double* from = rows.at(found.index[n], 0);
            for (std::size_t k = 0; k < size; ++k) c[k] += found.weight[n] * from[k];
        }
        return light.radiance(c, rows.order, found.turn);
    });
}

Radiance fromMatrix(const Representation& matrix, const BasisLight& light, const Views& views) {
    const CoefficientHead& head = matrix.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    const ProductSymmetry symmetry = symmetryOf(matrix);
    const std::vector<ProductTerm> terms = productTerms(*basis, symmetry);
    const std::vector<double> values = matrixValues(matrix);
    const std::size_t channels = head.channels.count(), slots = head.slots();
    return forEachView(views, [&](const Direction& wo) {
        std::vector<double> atWo(slots), c(channels * slots, 0.0);
        basis->evaluate(wo, atWo.data());
        for (std::size_t channel = 0; channel < channels; ++channel) {
            contractWithOutgoing(terms, symmetry, values.data() + channel * terms.size(),
                                 atWo.data(), c.data() + channel * slots);
        }
        return light.radiance(c, head.order, 0);
    });
}

}  // namespace

Radiance outgoingRadiance(const Brdf& brdf, const LightSamples& light, const Views& views) {
    return forEachView(views, [&](const Direction& wo) { return radianceAt(brdf, light, wo); });
}

Radiance outgoingRadiance(const PairEvaluator& evaluator, std::size_t channels,
                          const LightSamples& light, const Views& views) {
    return forEachView(
        views, [&](const Direction& wo) { return radianceAt(evaluator, channels, light, wo); });
}

BasisLight::BasisLight(const Basis& basis, Quantity quantity, const LightSamples& light)
    : order_(basis.order()) {
    const auto slots = static_cast<std::size_t>(basis.slots());
    // Columns beyond the slots of one direction belong to the next direction: their sums are left
    // out.
    const std::size_t columns = (slots + laneGroup - 1) / laneGroup * laneGroup;
    // Values of a batch stay in the cache.
    const std::size_t most =
        std::min(light.count(), std::clamp<std::size_t>(keptValues / slots, 16, batchSize));
    std::vector<double> table(most * slots + columns - slots), flux(3 * most),
        sums(3 * columns, 0.0);
    for (std::size_t first = 0; first < light.count(); first += most) {
        const std::size_t count = std::min(most, light.count() - first);
        basis.evaluate({&light.x[first], &light.y[first], &light.z[first], count}, table.data());
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < count; ++k) {
                const double cosine = quantity == Quantity::brdf ? light.z[first + k] : 1;
                flux[c * most + k] = light.flux[c][first + k] * cosine;
            }
        }
        addProducts({flux.data(), 3, most}, {table.data(), columns, slots}, count, sums.data(),
                    columns);
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const auto from = sums.begin() + static_cast<std::ptrdiff_t>(c * columns);
        values_.insert(values_.end(), from, from + static_cast<std::ptrdiff_t>(slots));
    }
}

Rgb BasisLight::radiance(std::span<const double> coefficients, int order, double turn) const {
    const auto slots = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    const std::size_t own = values_.size() / 3;
    const bool grey = coefficients.size() == slots;
    Rgb sum{};
    const double c1 = std::cos(turn), s1 = std::sin(turn);
    double cosine = 1, sine = 0;  // of m times the turn
    for (int m = 0; m < order; ++m) {
        for (int l = m; l < order; ++l) {
            const auto plus = static_cast<std::size_t>(slotOf(l, m));
            const auto minus = static_cast<std::size_t>(slotOf(l, -m));
            for (std::size_t c = 0; c < 3; ++c) {
                const double* from = coefficients.data() + (grey ? 0 : c) * slots;
                const double a = values_[c * own + plus], b = values_[c * own + minus];
                sum[c] += from[plus] * (cosine * a + (m > 0 ? sine * b : 0));
                if (m > 0) sum[c] += from[minus] * (cosine * b - sine * a);
            }
        }
        const double next = cosine * c1 - sine * s1;
        sine = sine * c1 + cosine * s1;
        cosine = next;
    }
    return sum;
}

std::vector<double> BasisLight::bandPower() const {
    const std::size_t slots = values_.size() / 3;
    std::vector<double> power(static_cast<std::size_t>(order_), 0.0);
    for (int l = 0; l < order_; ++l) {
        for (int m = -l; m <= l; ++m) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double value = values_[c * slots + static_cast<std::size_t>(slotOf(l, m))];
                power[static_cast<std::size_t>(l)] += value * value;
            }
        }
    }
    return power;
}

Radiance linearRadiance(const Representation& representation, const BasisLight& light,
                        const Views& views) {
    return representation.kind() == Representation::Kind::outgoing
               ? fromRows(decoded(representation), light, views)
               : fromMatrix(representation, light, views);
}

}  // namespace hshfit::inline light
