#include <hshfit/material_maps/exports/map_sampler.h>

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/gpu/containers/test_triples.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline material_maps::inline exports {
namespace {

std::size_t wrapped(double at, std::size_t side, Wrap wrap) {
    const auto length = static_cast<double>(side);
    if (wrap == Wrap::repeat) at -= length * std::floor(at / length);
    return static_cast<std::size_t>(std::clamp(at, 0.0, length - 1));
}

double single(double value) {
    return static_cast<double>(static_cast<float>(value));
}

}  // namespace

std::vector<MapCorner> mapCorners(std::span<const LevelSize> levels, const MapPlace& place,
                                  Wrap wrap) {
    const double last = static_cast<double>(levels.size() - 1);
    const double level = std::clamp(place.level, 0.0, last), finer = std::floor(level);
    std::vector<MapCorner> corners;
    for (const int k : {0, 1}) {
        const auto at = static_cast<std::size_t>(std::min(finer + k, last));
        const LevelSize& size = levels[at];
        const double x = place.u * static_cast<double>(size.width) - 0.5;
        const double y = place.v * static_cast<double>(size.height) - 0.5;
        const double partX = x - std::floor(x), partY = y - std::floor(y);
        const double between = k == 1 ? level - finer : 1 - (level - finer);
        for (const int j : {0, 1}) {
            for (const int i : {0, 1}) {
                const double share =
                    between * (i == 1 ? partX : 1 - partX) * (j == 1 ? partY : 1 - partY);
                if (share == 0) continue;
                corners.push_back({at, wrapped(std::floor(x) + i, size.width, wrap),
                                   wrapped(std::floor(y) + j, size.height, wrap), share});
            }
        }
    }
    return corners;
}

std::vector<double> mapValue(const MaterialMap& map, const MapPlace& place, Wrap wrap,
                             const Direction& wo, const Direction& wi) {
    const std::size_t channels = map.sidecar().channels.count();
    std::vector<double> sum(channels, 0.0), q(channels);
    for (const MapCorner& corner : mapCorners(map.sidecar().levels, place, wrap)) {
        const Reconstruction texel(map.coefficients(corner.level, corner.column, corner.row));
        texel.evalQuantity(wo, {&wi.x, &wi.y, &wi.z, 1}, q.data());
        for (std::size_t c = 0; c < channels; ++c) sum[c] += corner.share * q[c];
    }
    return sum;
}

std::vector<MapTest> mapTests(std::span<const LevelSize> levels, const MapValue& value) {
    std::vector<MapTest> tests;
    std::size_t k = 0;
    for (const gpu::TestTriple& pair : gpu::testPairs()) {
        // The additive recurrence in powers of the root of x^3 = x + 1 (Roberts).
        const double order = static_cast<double>(k + 1), across = order * 0.7548776662466927,
                     down = order * 0.5698402909980532;
        MapPlace place{single(across - std::floor(across)), single(down - std::floor(down)), 0};
        if (k % 3 == 0) {
            const std::size_t level = k / 3 % levels.size();
            const auto centre = [](double at, std::size_t side) {
                const auto length = static_cast<double>(side);
                return single((std::floor(at * length) + 0.5) / length);
            };
            place = {centre(place.u, levels[level].width), centre(place.v, levels[level].height),
                     static_cast<double>(level)};
        } else if (k % 3 == 2) {
            place.level = single(static_cast<double>(levels.size() - 1) * place.u);
        }
        tests.push_back({place, pair.wo, pair.wi, value(place, pair.wo, pair.wi)});
        ++k;
    }
    return tests;
}

std::vector<MapTest> mapTests(const MaterialMap& map, Wrap wrap) {
    return mapTests(map.sidecar().levels,
                    [&](const MapPlace& place, const Direction& wo, const Direction& wi) {
                        return mapValue(map, place, wrap, wo, wi);
                    });
}

}  // namespace hshfit::inline material_maps::inline exports
