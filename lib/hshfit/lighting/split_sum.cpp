#include <hshfit/lighting/split_sum.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/lobe_nodes.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace hshfit::lighting {
namespace {

constexpr std::size_t mostLevels = 8;

/// The level between whose kernels the mean cosine is linear, so that a trilinear lookup has it.
double levelOf(double cosine, const std::vector<double>& cosines) {
    std::size_t k = 0;
    while (k + 1 < cosines.size() && cosines[k + 1] > cosine) ++k;
    if (k + 1 == cosines.size()) return static_cast<double>(k);
    const double share = (cosines[k] - cosine) / (cosines[k] - cosines[k + 1]);
    return static_cast<double>(k) + std::clamp(share, 0.0, 1.0);
}

/// A table whose even part is the share `evenShare`.
SplitSumTable tableWith(const Brdf& brdf, const std::vector<LobeNodes>& nodes, ElevationRows rows,
                        double evenShare) {
    SplitSumTable result{.kernel = LobeKernel(brdf, evenShare), .table = ElevationTable(rows, 2)};
    std::vector<LobeSummary> lobes;
    for (const LobeNodes& row : nodes) lobes.push_back(summarise(row, evenShare));
    double narrow = 1e30, wide = 0;
    for (const LobeSummary& lobe : lobes) {
        if (lobe.meanCosine >= 1) continue;  // no rest
        const double scale = result.kernel.scaleFor(lobe.meanCosine);
        narrow = std::min(narrow, scale);
        wide = std::max(wide, scale);
    }
    if (wide == 0) narrow = wide = 1;
    // A little above a whole number of levels is that number: the widest row loses nothing visible.
    result.levels =
        1 + static_cast<std::size_t>(std::max(0.0, std::ceil(std::log2(wide / narrow) - 0.02)));
    result.levels = std::min(result.levels, mostLevels);
    result.firstScale = std::max(narrow, wide / std::ldexp(1.0, mostLevels - 1));
    std::vector<double> cosines;
    for (std::size_t k = 0; k < result.levels; ++k)
        cosines.push_back(
            result.kernel.meanCosine(std::ldexp(result.firstScale, static_cast<int>(k))));
    result.firstWidth = std::acos(cosines.front());
    for (std::size_t k = 0; k < rows.count; ++k) {
        const std::span<double> row = result.table.row(k);
        for (std::size_t c = 0; c < 3; ++c) {
            row[c] = lobes[k].even[c];
            row[4 + c] = lobes[k].rest[c];
        }
        row[3] = levelOf(lobes[k].meanCosine, cosines);
        row[7] = std::atan2(-lobes[k].axis.x, lobes[k].axis.z);
        const LobeKernel::Scaled kernel = result.kernel.scaled(
            lobes[k].meanCosine < 1 ? result.kernel.scaleFor(lobes[k].meanCosine) : 1);
        result.misplaced +=
            misplaced(nodes[k], lobes[k],
                      [&](const Direction& d) { return kernel.at(dot(d, lobes[k].axis)); }) /
            static_cast<double>(rows.count);
    }
    return result;
}

}  // namespace

SplitSumTable fitSplitSum(const Brdf& brdf, ElevationRows rows) {
    requireIsotropic(brdf);
    std::vector<LobeNodes> nodes(rows.count);
    tbb::parallel_for(std::size_t{0}, rows.count, [&](std::size_t k) {
        nodes[k] = lobeNodes(brdf, directionFromAngles(std::acos(rows.cosine(k)), 0), 2);
    });
    std::optional<SplitSumTable> best;
    for (const double share : evenShares) {
        SplitSumTable table = tableWith(brdf, nodes, rows, share);
        if (!best || table.misplaced < best->misplaced) best = std::move(table);
    }
    return *std::move(best);
}

EnvironmentCube prefilter(const SplitSumTable& table, std::span<const Light> lights,
                          std::size_t mostFace) {
    const std::size_t least = std::size_t{2} << (table.levels - 1);
    std::size_t face = std::max<std::size_t>(8, least);
    while (face < mostFace && static_cast<double>(face) < 4 * (pi / 2) / table.firstWidth)
        face *= 2;
    EnvironmentCube cube;
    for (std::size_t k = 0; k < table.levels; ++k) {
        const double scale = std::ldexp(table.firstScale, static_cast<int>(k));
        const LobeKernel::Scaled kernel = table.kernel.scaled(scale);
        const double width = std::acos(table.kernel.meanCosine(scale));
        const int order = static_cast<int>(std::clamp(5 / width, 10.0, 128.0));
        cube.levels.push_back(
            convolve(lights, face >> k, order, [&](double cosine) { return kernel.at(cosine); }));
    }
    return cube;
}

irradiance::NineRgb irradianceNine(std::span<const Light> lights) {
    const LightCoefficients light = projectLight(lights, *bases::make("sh", 3));
    irradiance::NineRgb radiance{};
    for (std::size_t i = 0; i < 9; ++i)
        for (std::size_t c = 0; c < 3; ++c) radiance[i][c] = light.at(c)[i];
    return irradiance::irradianceOf(radiance);
}

Rgb radiance(const SplitSumTable& table, const EnvironmentCube& cube,
             const irradiance::NineRgb& irradiance, const Direction& normal,
             const Direction& viewer) {
    const ViewAxes axes(normal, viewer);
    if (!(axes.cosine > 0)) return {};
    std::array<double, 8> row{};
    table.table.at(axes.cosine, row);
    const Rgb even = irradiance::evaluateNine(irradiance, normal);
    const Rgb rest = cube.at(axes.toWorld({-std::sin(row[7]), 0, std::cos(row[7])}), row[3]);
    Rgb result{};
    for (std::size_t c = 0; c < 3; ++c) result[c] = row[c] * even[c] / pi + row[4 + c] * rest[c];
    return result;
}

}  // namespace hshfit::lighting
