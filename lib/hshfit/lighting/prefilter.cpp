#include <hshfit/lighting/prefilter.h>

#include <hshfit/error.h>
#include <hshfit/lighting/lobe_kernel.h>
#include <hshfit/specification/parameters.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::lighting {
namespace {

double last(std::size_t levels) {
    return static_cast<double>(levels - 1);
}

/// three.js r187 (PMREMGenerator.lodToRoughness) and Filament (perceptualRoughnessToLod).
double quadraticLevel(double r, std::size_t levels) {
    return last(levels) * r * (2 - r);
}
/// PerceptualRoughnessToMipmapLevel of Unity's render pipelines.
double unityLevel(double r, std::size_t levels) {
    return last(levels) * r * (1.7 - 0.7 * r);
}
/// ComputeReflectionCaptureMipFromRoughness of Unreal: a level for 2^(1/1.2) in roughness, the one
/// of 2 x 2 texels having roughness 1. Sharper lookups have level 0.
double unrealLevel(double r, std::size_t levels) {
    return std::clamp(last(levels) + 1.2 * std::log2(std::max(r, 1e-3)), 0.0, last(levels));
}
/// HDRFiltering of Babylon.js: alpha = 2^(level / 0.8) texels of a face of 128; levels beyond the
/// fifth are wider than its irradiance, which is the last here.
double babylonLevel(double r, std::size_t levels) {
    const double cube = last(levels) - 1;
    return std::clamp(cube + 0.6 + 1.6 * std::log2(std::max(r, 1e-3)), 0.0, cube) +
           std::max(0.0, 4.369 * r - 3.369);
}
/// EnvLighting.generateAtlas of PlayCanvas: 2/11 in roughness for a level; its irradiance is the
/// last.
double playcanvasLevel(double r, std::size_t levels) {
    return std::max((last(levels) - 0.5) * r, 11 * r - 11 + last(levels));
}
constexpr std::array prefilterTable{
    Prefilter{"three", "three.js on a panorama 1024 wide: six levels, faces of 256 texels", 6,
              quadraticLevel, "{0} * r * (2.0 - r)"},
    Prefilter{"three-512", "three.js on a panorama 2048 wide: seven levels, faces of 512 texels", 7,
              quadraticLevel, "{0} * r * (2.0 - r)"},
    Prefilter{"filament", "Filament: five levels, as cmgen writes them", 5, quadraticLevel,
              "{0} * r * (2.0 - r)"},
    Prefilter{"unity", "Unity: seven levels of a reflection probe", 7, unityLevel,
              "{0} * r * (1.7 - 0.7 * r)"},
    Prefilter{"unreal", "Unreal Engine: seven levels of a reflection capture", 7, unrealLevel,
              "clamp({0} + 1.2 * log2(max(r, 0.001)), 0.0, {0})"},
    Prefilter{"babylon", "Babylon.js: six levels of its filter of HDR files, and the irradiance", 7,
              babylonLevel,
              "clamp({0} - 0.4 + 1.6 * log2(max(r, 0.001)), 0.0, {0} - 1.0) + "
              "max(0.0, 4.369 * r - 3.369)"},
    Prefilter{"playcanvas", "PlayCanvas: six levels of an environment atlas, and the ambient light",
              7, playcanvasLevel, "max(({0} - 0.5) * r, 11.0 * r - 11.0 + {0})"},
};

/// Nodes of gamma that resolve P_r: even in the logarithm of t = tan(gamma / 2), whose d omega is
/// 8 pi t dt / (1 + t^2)^2.
template <class Add>
void overKernel(double roughness, const Add& add) {
    constexpr int steps = 4000;
    constexpr double narrowest = 1e-7;
    const double alpha2 = std::pow(roughness, 4), step = -std::log(narrowest) / steps;
    for (int k = 0; k < steps; ++k) {
        const double t = narrowest * std::exp((k + 0.5) * step), t2 = t * t;
        const double cosine = (1 - t2) / (1 + t2), d = (alpha2 + t2) / (1 + t2);
        add(cosine, 8 * pi * t2 / std::pow(1 + t2, 2) * step * alpha2 * cosine / (d * d));
    }
}

/// The kernel for convolutions.
LobeKernel::Scaled kernelOf(double roughness) {
    const double alpha2 = std::pow(roughness, 4);
    std::vector<double> t, values;
    constexpr int samples = 800;
    for (int k = 0; k <= samples; ++k) {
        t.push_back(1e-6 * std::pow(1e6, k / static_cast<double>(samples)));
        const double t2 = t.back() * t.back(), d = (alpha2 + t2) / (1 + t2);
        values.push_back(alpha2 * (1 - t2) / (1 + t2) / (d * d));
    }
    return LobeKernel(std::move(t), std::move(values)).scaled(1);
}

}  // namespace

double Prefilter::roughnessOf(double place) const {
    if (!(place > 0)) return 0;
    double low = 0, high = 1;
    for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (levelOf(middle) < place ? low : high) = middle;
    }
    return high;
}

std::span<const Prefilter> prefilters() {
    return prefilterTable;
}

const Prefilter& prefilterNamed(std::string_view name) {
    std::vector<std::string_view> known;
    for (const Prefilter& row : prefilterTable) {
        if (row.name == name) return row;
        known.push_back(row.name);
    }
    throw UsageError(fmt::format("unknown engine '{}'{}; known: {}", name, suggestion(name, known),
                                 joined(known)));
}

std::vector<double> kernelBands(double roughness, int bands) {
    std::vector<double> result(static_cast<std::size_t>(bands), 0.0);
    if (!(roughness > 1e-3)) return std::vector<double>(result.size(), 1.0);
    overKernel(roughness, [&](double x, double weight) {
        double before = 0, here = 1;
        for (std::size_t l = 0; l < result.size(); ++l) {
            result[l] += weight * here;
            const auto n = static_cast<double>(l);
            const double next = ((2 * n + 1) * x * here - n * before) / (n + 1);
            before = here;
            here = next;
        }
    });
    for (std::size_t l = result.size(); l-- > 0;) result[l] /= result[0];
    return result;
}

std::vector<std::vector<double>> levelBands(const Prefilter& prefilter, int bands) {
    std::vector<std::vector<double>> levels;
    for (std::size_t k = 0; k < prefilter.levels; ++k)
        levels.push_back(kernelBands(prefilter.roughnessOf(static_cast<double>(k)), bands));
    return levels;
}

std::vector<double> lookUpBands(std::span<const std::vector<double>> levels, double place) {
    const std::size_t first = std::min(static_cast<std::size_t>(place), levels.size() - 2);
    const double share = place - static_cast<double>(first);
    std::vector<double> result = levels[first];
    for (std::size_t l = 0; l < result.size(); ++l)
        result[l] += share * (levels[first + 1][l] - result[l]);
    return result;
}

EnvironmentCube prefiltered(const Prefilter& prefilter, std::span<const Light> lights,
                            std::size_t lastFace) {
    const std::size_t first = lastFace << (prefilter.levels - 1);
    EnvironmentCube cube;
    cube.levels.push_back(rasterised(lights, first));
    for (std::size_t k = 1; k < prefilter.levels; ++k) {
        const double roughness = prefilter.roughnessOf(static_cast<double>(k));
        // Beyond tan(gamma / 2) = 3 alpha GGX has a tenth.
        cube.levels.push_back(convolve(cube.levels.front(), first >> k, kernelOf(roughness),
                                       6 * roughness * roughness));
    }
    return cube;
}

}  // namespace hshfit::lighting
