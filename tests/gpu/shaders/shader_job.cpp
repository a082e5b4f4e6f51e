#include "shader_job.h"

#include "../asymmetric.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rotation/sh_rotation.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::shaders {
namespace {

constexpr std::size_t shadeEvery = 31;

/// Hemisphere nodes fine enough for products of the basis and the light: Gauss-Legendre in
/// sqrt(cos theta) times equispaced azimuths.
struct Grid {
    std::vector<double> x, y, z, weight;

    explicit Grid(int bands) {
        const GaussRule& rule = gaussLegendre(bands + 24);
        const int azimuths = 2 * bands + 2;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double u = 0.5 * (1 + rule.nodes[i]), mu = u * u;
            const double sine = std::sqrt((1 - mu) * (1 + mu));
            for (int k = 0; k < azimuths; ++k) {
                const double phi = 2 * pi * (k + 0.25) / azimuths;
                x.push_back(sine * std::cos(phi));
                y.push_back(sine * std::sin(phi));
                z.push_back(mu);
                weight.push_back(rule.weights[i] * u * 2 * pi / azimuths);
            }
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

/// The coefficients of the light in the frame of a surface, [slot][colour].
std::vector<double> turned(const ShaderJob& job, const Direction& normal) {
    const auto [t, b, n] = frameOf(normal);
    const auto toFrame = Rotation::fromMatrix({t.x, t.y, t.z, b.x, b.y, b.z, n.x, n.y, n.z});
    const ShRotation rotation(job.environment.order,
                              {.condonShortley = job.payload.head.condonShortley});
    const std::size_t slots = job.environment.values.size() / job.lights();
    std::vector<double> values = job.environment.values;
    for (std::size_t i = 0; i < job.lights(); ++i) {
        std::vector<double> one(slots);
        for (std::size_t j = 0; j < slots; ++j) one[j] = values[j * job.lights() + i];
        one = rotation.rotate(toFrame, one);
        for (std::size_t j = 0; j < slots; ++j) values[j * job.lights() + i] = one[j];
    }
    return values;
}

/// Light times weight times, if f was projected, the cosine: [colour][node].
std::vector<double> lightOn(const Grid& grid, const ShaderJob& job,
                            const std::vector<double>& environment) {
    const int order = job.environment.order;
    const auto harmonics =
        bases::make("sh", order, {.condonShortley = job.payload.head.condonShortley});
    const std::size_t slots = static_cast<std::size_t>(order * order), count = grid.x.size();
    std::vector<double> values(count * slots), light(job.lights() * count, 0.0);
    harmonics->evaluate(grid.batch(), values.data());
    for (std::size_t k = 0; k < count; ++k) {
        const double factor =
            grid.weight[k] * (job.payload.head.quantity == Quantity::brdf ? grid.z[k] : 1);
        for (std::size_t i = 0; i < job.lights(); ++i) {
            for (std::size_t j = 0; j < slots; ++j) {
                light[i * count + k] +=
                    factor * values[k * slots + j] * environment[j * job.lights() + i];
            }
        }
    }
    return light;
}

/// Basis functions by bilinear lookup of the basis textures, in slots.
std::vector<double> tabulatedBasis(const gpu::Payload& payload, const std::vector<double>& texels,
                                   const Direction& wi) {
    const int side = payload.basisTexels->width;
    const auto position = [&](double v) { return 0.5 * (v / (1 + wi.z) * (side - 2) + side - 1); };
    const double px = position(wi.x), py = position(wi.y);
    const int x = std::clamp(static_cast<int>(px), 0, side - 2);
    const int y = std::clamp(static_cast<int>(py), 0, side - 2);
    std::vector<double> values(static_cast<std::size_t>(payload.head.order * payload.head.order),
                               0.0);
    for (std::size_t j = 0; j < payload.slots.size(); ++j) {
        const auto at = [&](int i, int k) {
            const std::size_t layer = j / 4, s = static_cast<std::size_t>(side);
            return texels[((layer * s + static_cast<std::size_t>(k)) * s +
                           static_cast<std::size_t>(i)) *
                              4 +
                          j % 4];
        };
        const double u = px - x, v = py - y;
        values[static_cast<std::size_t>(payload.slots[j])] =
            (1 - v) * ((1 - u) * at(x, y) + u * at(x + 1, y)) +
            v * ((1 - u) * at(x, y + 1) + u * at(x + 1, y + 1));
    }
    return values;
}

void tabulatedSum(const ShaderJob& job, const Coefficients& c, const std::vector<double>& texels,
                  std::size_t pair, double* q) {
    const Direction &wo = job.pairs.wo[pair], &wi = job.pairs.wi[pair];
    std::fill_n(q, job.channels(), 0.0);
    if (wo.z <= 0 || wi.z <= 0) return;
    const OutgoingLookup found = lookUp(c.outgoing, wo);
    const auto basis = tabulatedBasis(job.payload, texels, rotateAboutZ(wi, -found.turn));
    for (int k = 0; k < found.count; ++k) {
        for (std::size_t i = 0; i < job.channels(); ++i) {
            for (std::size_t j = 0; j < c.slots(); ++j)
                q[i] += found.weight[k] * c.at(found.index[k], i)[j] * basis[j];
        }
    }
}

}  // namespace

Pairs directionPairs() {
    constexpr std::size_t count = Pairs::side * Pairs::side;
    Pairs pairs{samples::floatDirections(count, 11), samples::floatDirections(count, 12)};
    // Other pairs than pole with pole and horizon with horizon.
    std::shuffle(pairs.wi.begin(), pairs.wi.end(), std::mt19937_64(13));
    for (std::size_t k = 0; k < count; ++k) {
        if (k % 64 == 5) pairs.wo[k].z *= -1;
        if (k % 64 == 9) pairs.wi[k].z *= -1;
    }
    return pairs;
}

std::array<Direction, 3> frameOf(const Direction& n) {
    const double across = std::hypot(n.x, n.y);
    const double x = across > 0 ? -n.y / across : 1, y = across > 0 ? n.x / across : 0;
    const Direction rise{-n.z * y, n.z * x, n.x * y - n.y * x};
    return {Direction{0.6 * x + 0.8 * rise.x, 0.6 * y + 0.8 * rise.y, 0.8 * rise.z},
            Direction{0.6 * rise.x - 0.8 * x, 0.6 * rise.y - 0.8 * y, 0.6 * rise.z}, n};
}

Environment randomEnvironment(int order, std::size_t colours) {
    std::mt19937_64 random(21);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Environment environment{order, colours, {}};
    for (std::size_t k = 0; k < static_cast<std::size_t>(order * order) * colours; ++k)
        environment.values.push_back(static_cast<double>(static_cast<float>(uniform(random))));
    return environment;
}

ShaderJob makeJob(gpu::Payload payload, int environmentOrder) {
    const bool spectral = payload.head.channels.kind == Channels::Kind::spectral;
    const std::size_t colours = spectral ? payload.head.channels.count() : 3;
    return {std::move(payload), directionPairs(), randomEnvironment(environmentOrder, colours),
            false};
}

std::vector<double> reference(const ShaderJob& job) {
    const Reconstruction sums(gpu::unpack(job.payload));
    const Grid grid(job.payload.head.order + job.environment.order);
    std::vector<double> light = lightOn(grid, job, job.environment.values);
    const std::size_t nodes = grid.x.size(), channels = job.channels();
    std::vector<double> texels;
    if (job.payload.basisTexels) texels = gpu::decode(*job.payload.basisTexels);
    std::vector<double> result, q(channels), onGrid(channels * nodes);
    for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
        const Direction &wo = job.pairs.wo[k], &wi = job.pairs.wi[k];
        if (job.payload.basisTexels)
            tabulatedSum(job, sums.coefficients(), texels, k, q.data());
        else
            sums.evalQuantity(wo, {&wi.x, &wi.y, &wi.z, 1}, q.data());
        result.insert(result.end(), q.begin(), q.end());
        for (const double value : q) result.push_back(std::max(value, 0.0));
        if (k % shadeEvery != 0) {
            result.insert(result.end(), job.lights(), std::nan(""));
            continue;
        }
        if (job.world) light = lightOn(grid, job, turned(job, wi));
        sums.evalQuantity(wo, grid.batch(), onGrid.data());
        for (std::size_t i = 0; i < job.lights(); ++i) {
            const double* values = onGrid.data() + (channels == 1 ? 0 : i) * nodes;
            double sum = 0;
            for (std::size_t n = 0; n < nodes; ++n) sum += values[n] * light[i * nodes + n];
            result.push_back(sum);
        }
    }
    return result;
}

Wanted wantedOf(const ShaderJob& job, std::span<const double> expected) {
    const auto isShade = [&](std::size_t i) { return i % job.outputs() >= 2 * job.channels(); };
    double eval = 0, shade = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (std::isnan(expected[i])) continue;
        double& most = isShade(i) ? shade : eval;
        most = std::max(most, std::abs(expected[i]));
    }
    Wanted wanted{{expected.begin(), expected.end()}, {}};
    for (std::size_t i = 0; i < expected.size(); ++i)
        wanted.scales.push_back(isShade(i) ? shade : eval);
    return wanted;
}

Wanted writtenTwice(const ShaderJob& job, std::span<const double> values,
                    std::span<const double> scales) {
    const std::size_t channels = job.channels();
    Wanted wanted{std::vector<double>(job.pairs.wo.size() * job.outputs(), std::nan("")), {}};
    wanted.scales.assign(wanted.values.size(), 1);
    for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
        for (std::size_t i = 0; i < 2 * channels; ++i) {
            wanted.values[k * job.outputs() + i] = values[k * channels + i % channels];
            wanted.scales[k * job.outputs() + i] = scales[k * channels + i % channels];
        }
    }
    return wanted;
}

Difference compare(const ShaderJob& job, std::span<const double> expected,
                   std::span<const float> found) {
    Wanted eval = wantedOf(job, expected), shade = eval;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        Wanted& other = i % job.outputs() < 2 * job.channels() ? shade : eval;
        other.values[i] = std::nan("");
    }
    return {largestDifference(eval, found), largestDifference(shade, found)};
}

}  // namespace hshfit::shaders
