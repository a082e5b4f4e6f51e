#include <hshfit/light/light_energy.h>

#include <hshfit/light/internal/picture_nodes.h>
#include <hshfit/light/picture_light.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace hshfit::inline light {
namespace {

constexpr int resolution = 16;  ///< bands that nodes resolve at the first level

/// Where two lights overlap, the later in this order has the finer nodes.
int fineness(const Light& light) {
    if (std::holds_alternative<PictureLight>(light)) return 0;
    if (std::holds_alternative<SkyLight>(light) || std::holds_alternative<CoefficientLight>(light))
        return 1;
    if (std::holds_alternative<PanelLight>(light)) return 2;
    return std::holds_alternative<DiscLight>(light) ? 3 : 4;
}

double product(const Rgb& a, const Rgb& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Integral of L (L + 2 L') over one light's part of the domain, L' the sum of `others`.
double withOthers(const Light& light, std::span<const Light> others, const LightDomain& domain,
                  bool projected, int level) {
    const Frame frame = domain.frame();
    const LightNodes nodes = nodesOf(light, domain, resolution, level);
    double sum = 0;
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        const double weight = nodes.weight[k] * (projected ? nodes.z[k] : 1);
        if (!(nodes.weight[k] > 0)) continue;
        Rgb own{};
        for (std::size_t c = 0; c < 3; ++c) own[c] = nodes.flux[c][k] / nodes.weight[k];
        Rgb all = own;
        if (!others.empty()) {
            const Rgb other =
                radianceFrom(others, frame.toWorld({nodes.x[k], nodes.y[k], nodes.z[k]}));
            for (std::size_t c = 0; c < 3; ++c) all[c] += 2 * other[c];
        }
        sum += weight * product(own, all);
    }
    return sum;
}

double ofPicture(const PictureLight& light, std::span<const Light> others,
                 const LightDomain& domain, bool projected) {
    const PictureWeights weights(light, domain);
    const Frame frame = domain.frame();
    double sum = 0;
    for (std::size_t row = 0; row < light.height; ++row) {
        for (std::size_t column = 0; column < light.width; ++column) {
            const float* rgb = light.rgb.data() + 3 * (row * light.width + column);
            const Rgb own{rgb[0], rgb[1], rgb[2]};
            Rgb all = own;
            const Direction world = directionOf(light, static_cast<double>(column) + 0.5,
                                                static_cast<double>(row) + 0.5);
            if (!others.empty()) {
                const Rgb other = radianceFrom(others, world);
                for (std::size_t c = 0; c < 3; ++c) all[c] += 2 * other[c];
            }
            const double cosine = projected ? std::max(frame.toLocal(world).z, 0.0) : 1;
            sum += weights.solidAngle(row, column) * cosine * product(own, all);
        }
    }
    return sum;
}

}  // namespace

Energy lightEnergy(std::span<const Light> lights, const LightDomain& domain, bool projected,
                   std::span<const std::optional<double>> known) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::size_t> sorted(lights.size());
    std::iota(sorted.begin(), sorted.end(), std::size_t{0});
    std::stable_sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) {
        return fineness(lights[a]) < fineness(lights[b]);
    });
    Energy energy;
    std::vector<Light> coarser;
    for (const std::size_t k : sorted) {
        const Light& light = lights[k];
        if (std::holds_alternative<DirectionalLight>(light)) {
            return {none, none, false,
                    "light from a single direction has an infinite radiance there, and no energy"};
        }
        const auto* picture = std::get_if<PictureLight>(&light);
        if (known[k] && coarser.empty()) {
            energy.value += *known[k];
        } else if (picture) {
            energy.value += ofPicture(*picture, coarser, domain, projected);
        } else {
            const double coarse = withOthers(light, coarser, domain, projected, 0);
            const double fine = withOthers(light, coarser, domain, projected, 1);
            energy.value += fine;
            energy.error += std::abs(fine - coarse);
        }
        if (lights.size() > 1) coarser.push_back(light);
    }
    energy.error += std::numeric_limits<double>::epsilon() * energy.value;
    return energy;
}

}  // namespace hshfit::inline light
