#include <hshfit/light/internal/picture_filling.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr std::size_t mostFilled = 65536;

using Place = std::pair<std::size_t, std::size_t>;  // row, column

bool before(const FilledPixel& pixel, const Place& place) {
    return Place(pixel.row, pixel.column) < place;
}

FilledPixels invalidPixels(const std::string& path, const PictureOptions& options) {
    PictureReader reader(path, options);
    const PictureGeometry& geometry = reader.facts().geometry;
    FilledPixels found;
    reader.forEachRow([&](std::size_t row, std::span<const float> rgb) {
        for (std::size_t column = 0; column < geometry.width; ++column) {
            const auto pixel = rgb.subspan(3 * column, 3);
            if (std::ranges::all_of(pixel, [](float v) { return v >= 0 && std::isfinite(v); }))
                continue;
            if (!(geometry.solidAngle(column, row) > 0)) continue;
            found.push_back({row, column});
            if (found.size() > mostFilled)
                throw InputError(fmt::format(
                    "{}: more than {} pixels are no radiance; invalid=inpaint fills single ones",
                    path, mostFilled));
        }
    });
    return found;
}

/// The pixels across the edges of an invalid one: indices of invalid ones, places of the others.
struct Around {
    std::vector<std::size_t> invalid;
    std::vector<Place> valid;
    std::size_t count() const { return invalid.size() + valid.size(); }
};

std::vector<Around> neighbourhoods(const FilledPixels& pixels, const PictureGeometry& geometry) {
    constexpr std::pair<int, int> steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    std::vector<Around> all(pixels.size());
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        for (const auto& [right, down] : steps) {
            const auto next = geometry.neighbour(pixels[k].column, pixels[k].row, right, down);
            if (!next) continue;
            const Place place((*next)[1], (*next)[0]);
            if (const FilledPixel* other = pixelAt(pixels, place.first, place.second))
                all[k].invalid.push_back(static_cast<std::size_t>(other - pixels.data()));
            else
                all[k].valid.push_back(place);
        }
    }
    return all;
}

/// Whether each of them is connected with a valid one.
bool reachValid(const std::vector<Around>& all) {
    std::vector<std::vector<std::size_t>> from(all.size());
    std::vector<std::size_t> reached;
    std::vector<bool> known(all.size(), false);
    for (std::size_t k = 0; k < all.size(); ++k) {
        for (const std::size_t other : all[k].invalid) from[other].push_back(k);
        if (all[k].valid.empty()) continue;
        known[k] = true;
        reached.push_back(k);
    }
    for (std::size_t at = 0; at < reached.size(); ++at) {
        const std::vector<std::size_t>& next = from[reached[at]];
        for (const std::size_t k : next)
            if (!known[k]) known[k] = true, reached.push_back(k);
    }
    return reached.size() == all.size();
}

/// Sums of the valid pixels around each, [pixel][R, G, B].
Eigen::MatrixXd validSums(const std::function<void(const RowVisitor&)>& rows,
                          const std::vector<Around>& all) {
    std::vector<std::pair<Place, std::size_t>> wanted;
    for (std::size_t k = 0; k < all.size(); ++k)
        for (const Place& place : all[k].valid) wanted.emplace_back(place, k);
    std::ranges::sort(wanted);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(all.size()), 3);
    auto next = wanted.begin();
    rows([&](std::size_t row, std::span<const float> rgb) {
        for (; next != wanted.end() && next->first.first == row; ++next)
            for (std::size_t c = 0; c < 3; ++c)
                sums(static_cast<Eigen::Index>(next->second), static_cast<Eigen::Index>(c)) +=
                    static_cast<double>(rgb[3 * next->first.second + c]);
    });
    return sums;
}

}  // namespace

void fillFromAround(FilledPixels& pixels, const PictureGeometry& geometry,
                    const std::function<void(const RowVisitor&)>& rows,
                    const std::string& message) {
    const auto all = neighbourhoods(pixels, geometry);
    if (!reachValid(all)) throw InputError(message);
    const Eigen::MatrixXd sums = validSums(rows, all);
    const auto size = static_cast<Eigen::Index>(all.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index k = 0; k < size; ++k) {
        const Around& around = all[static_cast<std::size_t>(k)];
        entries.emplace_back(k, k, static_cast<double>(around.count()));
        for (const std::size_t other : around.invalid)
            entries.emplace_back(k, static_cast<Eigen::Index>(other), -1.0);
    }
    Eigen::SparseMatrix<double> laplace(size, size);
    laplace.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(laplace);
    const Eigen::MatrixXd solution = solver.solve(sums);
    for (Eigen::Index k = 0; k < size; ++k)
        for (Eigen::Index c = 0; c < 3; ++c)
            pixels[static_cast<std::size_t>(k)].rgb[static_cast<std::size_t>(c)] =
                static_cast<float>(std::max(solution(k, c), 0.0));
}

FilledPixels fillPixels(const std::string& path, const PictureOptions& options) {
    FilledPixels pixels = invalidPixels(path, options);
    if (pixels.empty()) return pixels;
    const auto rows = [&](const RowVisitor& visit) {
        PictureReader(path, options).forEachRow(visit);
    };
    fillFromAround(pixels, PictureReader(path, options).facts().geometry, rows,
                   path +
                       ": invalid=inpaint finds no valid pixel beside those that are no "
                       "radiance");
    return pixels;
}

const FilledPixel* pixelAt(const FilledPixels& pixels, std::size_t row, std::size_t column) {
    const Place place(row, column);
    const auto found = std::lower_bound(pixels.begin(), pixels.end(), place, before);
    if (found == pixels.end() || Place(found->row, found->column) != place) return nullptr;
    return &*found;
}

}  // namespace hshfit::inline light
