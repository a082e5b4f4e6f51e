#include "texel_brdfs.h"

#include <brdfs/catalog.h>
#include <brdfs/composed/sum.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::jobs {
namespace {

struct Grid {
    std::size_t columns, rows;
    static std::size_t place(std::size_t k, std::size_t taken, std::size_t all) {
        return (2 * k + 1) * all / (2 * taken);
    }
};

/// An even grid of at most `most` places in a rectangle.
Grid gridOver(std::size_t width, std::size_t height, std::size_t most) {
    const double share = std::sqrt(static_cast<double>(most) /
                                   (static_cast<double>(width) * static_cast<double>(height)));
    const auto of = [&](std::size_t side) {
        return std::clamp<std::size_t>(static_cast<std::size_t>(share * static_cast<double>(side)),
                                       1, side);
    };
    const std::size_t columns = std::min(of(width), most);
    return {columns, std::clamp<std::size_t>(most / columns, 1, of(height))};
}

/// A texel of level 0 that belongs to one of the places.
struct Part {
    std::size_t row, column, of;
    double share;
};

}  // namespace

std::string specificationOf(const ParameterMaps& maps, const std::vector<float>& row,
                            std::size_t column) {
    std::string spec = maps.common();
    std::size_t at = 0;
    for (const VaryingParameter& parameter : maps.varying()) {
        spec += fmt::format("{}{}=", spec.find(':') == std::string::npos ? ':' : ',',
                            parameter.row->name);
        for (std::size_t c = 0; c < parameter.channels; ++c) {
            spec += fmt::format("{}{}", c > 0 ? "/" : "",
                                static_cast<double>(row[at++ * maps.width() + column]));
        }
    }
    return spec;
}

std::vector<TexelPlace> spreadPlaces(const std::vector<LevelSize>& levels, std::size_t level,
                                     std::size_t most) {
    const auto [width, height] = levels[level];
    const Grid grid = gridOver(width, height, most);
    std::vector<TexelPlace> places;
    for (std::size_t r = 0; r < grid.rows; ++r)
        for (std::size_t c = 0; c < grid.columns; ++c)
            places.push_back(
                {level, Grid::place(c, grid.columns, width), Grid::place(r, grid.rows, height)});
    return places;
}

std::vector<SpecShares> brdfsOfTexels(ParameterMaps& maps, const std::vector<LevelSize>& levels,
                                      const std::vector<TexelPlace>& places, std::size_t most) {
    std::vector<Part> parts;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const TexelPlace& place = places[k];
        const std::size_t across = levels[0].width / levels[place.level].width;
        const std::size_t down = levels[0].height / levels[place.level].height;
        const Grid grid = gridOver(across, down, most);
        const double share = 1 / static_cast<double>(grid.columns * grid.rows);
        for (std::size_t r = 0; r < grid.rows; ++r)
            for (std::size_t c = 0; c < grid.columns; ++c)
                parts.push_back({place.row * down + Grid::place(r, grid.rows, down),
                                 place.column * across + Grid::place(c, grid.columns, across), k,
                                 share});
    }
    std::ranges::stable_sort(parts, {}, &Part::row);
    std::vector<SpecShares> result(places.size());
    std::vector<float> row;
    std::size_t read = maps.height();
    for (const Part& part : parts) {
        if (part.row != read) row = maps.row(read = part.row);
        result[part.of][specificationOf(maps, row, part.column)] += part.share;
    }
    return result;
}

std::unique_ptr<Brdf> openShares(const SpecShares& shares) {
    if (shares.size() == 1) return brdfs::openModel(shares.begin()->first);
    std::vector<brdfs::Sum::Term> terms;
    for (const auto& [spec, share] : shares) terms.push_back({share, brdfs::openModel(spec)});
    return std::make_unique<brdfs::Sum>(std::move(terms));
}

}  // namespace hshfit::jobs
