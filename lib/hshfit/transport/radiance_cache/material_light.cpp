#include <hshfit/transport/radiance_cache/material_light.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/projection.h>
#include <hshfit/transport/radiance_cache/light_walk.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

constexpr int elevations = 64;
constexpr int parabolicEdge = 48;

/// The lowest order that keeps all but `loss` of the energy, or 0.
int orderWithin(const Projection& projection, double loss, bool nested) {
    const double energy = projection.coefficients.energy.value;
    const int highest = projection.coefficients.order;
    for (int n = nested ? 1 : highest; n <= highest; ++n)
        if (projection.captured[static_cast<std::size_t>(n - 1)] >= (1 - loss) * energy) return n;
    return 0;
}

class Chooser {
public:
    Chooser(const SurfaceScene& scene, const MaterialChoiceOptions& options)
        : scene_(scene),
          options_(options),
          entry_(bases::find(options.basis)),
          basis_(bases::make(options.basis, options.order)) {
        if (!entry_.orthonormal) {
            throw UsageError(fmt::format("{} '{}' is not orthonormal, which a dot product needs",
                                         Setting{"CacheOptions::basis"}, options.basis));
        }
        result_.kinds.emplace_back();
    }

    MaterialLights chosen() {
        const DiffuseMaterials diffuse(scene_);
        for (std::size_t k = 0; k < scene_.materials().size(); ++k) {
            MaterialLight light;
            if (diffuse.at(k)) {
                light.way = LightWay::irradiance;
                light.diffuse = *diffuse.at(k);
            } else {
                try {
                    light = projected(*scene_.materials()[k].brdf);
                } catch (const NumericError& error) {
                    light.reason = error.what();
                }
            }
            result_.materials.push_back(std::move(light));
        }
        return std::move(result_);
    }

private:
    MaterialLight projected(const Brdf& brdf) {
        const bool cosine = basis_->inner() == Basis::Inner::projectedSolidAngle;
        const Basis* basis = basis_.get();
        MaterialLight light;
        light.outgoing = brdf.laws().isotropic
                             ? OutgoingSet::elevations(elevations)
                             : OutgoingSet::parabolic(parabolicEdge, parabolicEdge);
        const std::vector<Projection> all =
            project(brdf, {&basis, 1}, light.outgoing,
                    {.quantity = cosine ? Quantity::brdf : Quantity::brdfCosine,
                     .tolerance = std::max(1e-4, brdf.defaultTolerance()),
                     .maxEvaluations = std::size_t{1} << 22});
        const Projection& projection = all.front();
        light.order = orderWithin(projection, options_.loss, entry_.nested);
        const int last = light.order > 0 ? light.order : options_.order;
        const double energy = projection.coefficients.energy.value;
        light.loss = 1 - projection.captured[static_cast<std::size_t>(last - 1)] / energy;
        if (light.order == 0) return light;
        light.way = LightWay::coefficients;
        light.kind = kindOf(light.order);
        const IncomingFunctions& functions = result_.kinds[light.kind];
        light.channels = projection.coefficients.channels.count();
        for (std::size_t o = 0; o < light.outgoing.size(); ++o) {
            for (std::size_t c = 0; c < light.channels; ++c) {
                const double* values = projection.coefficients.at(o, c);
                for (const int slot : functions.slots())
                    light.values.push_back(static_cast<float>(values[slot]));
            }
        }
        return light;
    }

    std::uint32_t kindOf(int order) {
        for (std::size_t k = 1; k < result_.kinds.size(); ++k) {
            if (result_.kinds[k].basis()->order() == order) return static_cast<std::uint32_t>(k);
        }
        result_.kinds.emplace_back(bases::make(options_.basis, order));
        return static_cast<std::uint32_t>(result_.kinds.size() - 1);
    }

    const SurfaceScene& scene_;
    const MaterialChoiceOptions& options_;
    const bases::Entry& entry_;
    std::unique_ptr<Basis> basis_;
    MaterialLights result_;
};

}  // namespace

void MaterialLight::at(const IncomingFunctions& functions, const Direction& wo, float* out) const {
    const std::size_t size = functions.size();
    const OutgoingLookup found = lookUp(outgoing, wo);
    std::fill_n(out, channels * size, 0.0F);
    for (int k = 0; k < found.count; ++k) {
        const auto n = static_cast<std::size_t>(k);
        const auto weight = static_cast<float>(found.weight[n]);
        const float* from = values.data() + found.index[n] * channels * size;
        for (std::size_t i = 0; i < channels * size; ++i) out[i] += weight * from[i];
    }
    if (found.turn == 0) return;
    const int bands = functions.basis()->order();
    std::vector<float> turns(2 * static_cast<std::size_t>(bands));
    for (int m = 0; m < bands; ++m) {
        turns[2 * static_cast<std::size_t>(m)] = static_cast<float>(std::cos(m * found.turn));
        turns[2 * static_cast<std::size_t>(m) + 1] = static_cast<float>(std::sin(m * found.turn));
    }
    for (std::size_t c = 0; c < channels; ++c) {
        for (const IncomingFunctions::Pair& pair : functions.pairs()) {
            const auto m = static_cast<std::size_t>(pair.m);
            float& plus = out[c * size + pair.cosine];
            float& minus = out[c * size + pair.sine];
            const float a = plus, b = minus;
            plus = a * turns[2 * m] - b * turns[2 * m + 1];
            minus = a * turns[2 * m + 1] + b * turns[2 * m];
        }
    }
}

MaterialLights chooseLight(const SurfaceScene& scene, const MaterialChoiceOptions& options) {
    return Chooser(scene, options).chosen();
}

}  // namespace hshfit::inline transport::inline radiance_cache
