#include <hshfit/lighting/split_sum.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/internal/lobe_taps.h>
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
constexpr std::size_t mostJudged = 4096;  // nodes that taps are judged by
constexpr double enough = 0.98;           // of the misplaced light, for more taps

/// The level between whose kernels the mean cosine is linear, so that a trilinear lookup has it.
double levelOf(double cosine, const std::vector<double>& cosines) {
    std::size_t k = 0;
    while (k + 1 < cosines.size() && cosines[k + 1] > cosine) ++k;
    if (k + 1 == cosines.size()) return static_cast<double>(k);
    const double share = (cosines[k] - cosine) / (cosines[k] - cosines[k + 1]);
    return static_cast<double>(k) + std::clamp(share, 0.0, 1.0);
}

/// One row's lobe and, where it is not its own mirror image, how it is spread.
struct RowLobe {
    LobeSummary summary;
    SpreadLobe spread = {};
    double scale = 1;  ///< of the kernel

    bool any() const { return summary.meanCosine < 1; }  ///< there is a rest
    std::vector<Direction> axes(const LobeTaps& taps) const {
        const Direction across = AcrossAxis(summary.axis).at(spread.angle);
        std::vector<Direction> result;
        for (const double offset : taps.offsets)
            result.push_back(turnedAside(summary.axis, across, offset * spread.spread));
        return result;
    }
    double misplaces(const LobeNodes& nodes, const LobeKernel::Scaled& kernel,
                     const LobeTaps& taps) const {
        if (spread.spread == 0)
            return misplaced(nodes, summary,
                             [&](const Direction& d) { return kernel.at(dot(d, summary.axis)); });
        const std::vector<Direction> directions = axes(taps);
        return misplaced(nodes, summary, [&](const Direction& d) {
            double sum = 0;
            for (std::size_t k = 0; k < directions.size(); ++k)
                sum += taps.weights[k] * kernel.at(dot(d, directions[k]));
            return sum;
        });
    }
    void write(double level, bool inPlane, std::span<double> row) const {
        for (std::size_t c = 0; c < 3; ++c) {
            row[c] = summary.even[c];
            row[4 + c] = summary.rest[c];
        }
        row[3] = level;
        if (inPlane) {
            row[7] = std::atan2(-summary.axis.x, summary.axis.z);
            return;
        }
        row[7] = spread.spread * std::cos(2 * spread.angle);
        row[8] = summary.axis.x;
        row[9] = summary.axis.y;
        row[10] = summary.axis.z;
        row[11] = spread.spread * std::sin(2 * spread.angle);
    }
};

/// Moments and nodes of a table's rows, in its order.
struct TableNodes {
    struct Row {
        LobeNodes nodes;  ///< some, where lobes are not their own mirror images
        std::array<LobeSummary, std::size(evenShares)> summaries;
        std::array<LobeSpread, std::size(evenShares)> spreads;
    };
    std::vector<Row> lobes;
    ElevationRows rows;
    AzimuthNodes azimuths;
    bool inPlane;

    TableNodes(const Brdf& brdf, ElevationRows where, std::size_t steps)
        : rows(where), azimuths(brdf.laws(), steps), inPlane(lobesInPlane(brdf.laws())) {
        lobes.resize(rows.count * azimuths.count);
        tbb::parallel_for(std::size_t{0}, lobes.size(), [&](std::size_t k) {
            Row& row = lobes[k];
            LobeNodes nodes =
                viewNodes(brdf, rows.cosine(k % rows.count), azimuths.angle(k / rows.count), 2);
            for (std::size_t share = 0; share < row.summaries.size(); ++share) {
                row.summaries[share] = summarise(nodes, evenShares[share]);
                if (!inPlane) row.spreads[share] = spreadOf(nodes, row.summaries[share]);
            }
            row.nodes = inPlane ? std::move(nodes) : thinned(nodes, mostJudged);
        });
    }
};

/// The levels of a table: kernels from the narrowest lobe's to the widest one's.
void setLevels(const std::vector<RowLobe>& lobes, SplitSumTable& table) {
    double narrow = 1e30, wide = 0;
    for (const RowLobe& lobe : lobes) {
        if (!lobe.any()) continue;
        narrow = std::min(narrow, lobe.scale);
        wide = std::max(wide, lobe.scale);
    }
    if (wide == 0) narrow = wide = 1;
    // A little above a whole number of levels is that number: the widest row loses nothing visible.
    table.levels =
        1 + static_cast<std::size_t>(std::max(0.0, std::ceil(std::log2(wide / narrow) - 0.02)));
    table.levels = std::min(table.levels, mostLevels);
    table.firstScale = std::max(narrow, wide / std::ldexp(1.0, mostLevels - 1));
}

/// A table whose even part is the share of that number.
SplitSumTable tableWith(const LobeKernel& kernel, const TableNodes& all, std::size_t share,
                        std::size_t tapCount) {
    SplitSumTable result{.kernel = kernel,
                         .taps = all.inPlane ? 0 : tapCount,
                         .table = ElevationTable(all.rows, all.inPlane ? 2 : 3, all.azimuths)};
    const LobeTaps taps(tapCount);
    const SpreadSolver solver(result.kernel, taps);
    std::vector<RowLobe> lobes;
    for (const TableNodes::Row& row : all.lobes) {
        RowLobe lobe{.summary = row.summaries[share]};
        lobe.spread.meanCosine = lobe.summary.meanCosine;
        if (lobe.any() && all.inPlane) {
            lobe.scale = kernel.scaleFor(lobe.summary.meanCosine);
        } else if (lobe.any()) {
            lobe.spread = solver.solve(lobe.summary.meanCosine, row.spreads[share]);
            lobe.scale = solver.scaleFor(lobe.spread.meanCosine);
        }
        lobes.push_back(lobe);
    }
    setLevels(lobes, result);
    std::vector<double> cosines;
    for (std::size_t k = 0; k < result.levels; ++k)
        cosines.push_back(
            result.kernel.meanCosine(std::ldexp(result.firstScale, static_cast<int>(k))));
    result.firstWidth = std::acos(cosines.front());
    std::vector<double> misplaces(lobes.size());
    tbb::parallel_for(std::size_t{0}, lobes.size(), [&](std::size_t k) {
        const RowLobe& lobe = lobes[k];
        lobe.write(levelOf(lobe.spread.meanCosine, cosines), all.inPlane,
                   result.table.row(k % all.rows.count, k / all.rows.count));
        misplaces[k] = lobe.misplaces(all.lobes[k].nodes, kernel.scaled(lobe.scale), taps);
    });
    for (const double part : misplaces)
        result.misplaced += part / static_cast<double>(lobes.size());
    return result;
}

/// The cube at the taps of a row of three texels.
Rgb spreadRadiance(const std::array<double, 12>& row, std::size_t tapCount,
                   const EnvironmentCube& cube, const ViewAxes& axes) {
    const double length = std::sqrt(row[8] * row[8] + row[9] * row[9] + row[10] * row[10]);
    const Direction axis{row[8] / length, row[9] / length, row[10] / length};
    const Direction across = AcrossAxis(axis).at(std::atan2(row[11], row[7]) / 2);
    const double spread = std::hypot(row[7], row[11]);
    const LobeTaps taps(tapCount);
    Rgb sum{};
    for (std::size_t k = 0; k < tapCount; ++k) {
        const Rgb light =
            cube.at(axes.toWorld(turnedAside(axis, across, taps.offsets[k] * spread)), row[3]);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += taps.weights[k] * light[c];
    }
    return sum;
}

}  // namespace

SplitSumTable fitSplitSum(const Brdf& brdf, ElevationRows rows, std::size_t azimuthSteps) {
    const TableNodes nodes(brdf, rows, azimuthSteps);
    std::optional<SplitSumTable> best;
    for (std::size_t share = 0; share < std::size(evenShares); ++share) {
        const LobeKernel kernel(brdf, evenShares[share]);
        for (const std::size_t taps : {1, 3, 5, 7, 9}) {
            if (nodes.inPlane && taps > 1) break;
            SplitSumTable table = tableWith(kernel, nodes, share, taps);
            const double bound = taps > 1 ? enough : 1;
            if (!best || table.misplaced < bound * best->misplaced) best = std::move(table);
        }
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
        cube.levels.push_back(convolve(lights, face >> k, order, kernel));
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
             const Direction& viewer, const Direction& tangent) {
    ViewAxes axes(normal, viewer, tangent);
    if (!(axes.cosine > 0)) return {};
    std::array<double, 12> row{};
    const bool mirrored =
        table.table.at(axes.cosine, axes.azimuth, {row.data(), 4 * table.table.texels});
    if (mirrored) axes.mirror();
    const Rgb even = irradiance::evaluateNine(irradiance, normal);
    const Rgb rest = table.taps == 0
                         ? cube.at(axes.toWorld({-std::sin(row[7]), 0, std::cos(row[7])}), row[3])
                         : spreadRadiance(row, table.taps, cube, axes);
    Rgb result{};
    for (std::size_t c = 0; c < 3; ++c) result[c] = row[c] * even[c] / pi + row[4 + c] * rest[c];
    return result;
}

}  // namespace hshfit::lighting
