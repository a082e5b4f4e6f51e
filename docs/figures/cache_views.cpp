// cache_views [SIZE PATHS [RAYS ACCURACY [VIEW]]]: pictures of indirect light by the radiance cache
// against path tracing in the twelve scenes of docs/results/illumination.md. Prints the rows of
// its table.

#include <hshfit/transport/radiance_cache/cached_picture.h>

#include <lib/transport/cache_views.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace {

using namespace hshfit;

double grey(const std::vector<float>& values, std::size_t pixel) {
    return (static_cast<double>(values[3 * pixel]) + static_cast<double>(values[3 * pixel + 1]) +
            static_cast<double>(values[3 * pixel + 2])) /
           3;
}

/// `distance` is the largest difference of a pixel from the picture by paths, relative to the mean
/// of that picture in the 5 x 5 pixels about it, or to a hundredth of the mean of the whole picture
/// if that is more, as where a horizon is all but black. `beyond` is the most by which a difference
/// exceeds three standard errors of both pictures.
struct Largest {
    double distance = 0, beyond = 0;
    int column = 0, row = 0;
};

double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values) sum += static_cast<double>(value);
    return sum / static_cast<double>(values.size());
}

Largest largest(const PathPicture& paths, const PathPicture& cached) {
    Largest found;
    const double darkest = mean(paths.radiance) / 100;
    for (int row = 0; row < paths.height; ++row) {
        for (int column = 0; column < paths.width; ++column) {
            double sum = 0;
            int count = 0;
            for (int y = std::max(0, row - 2); y < std::min(paths.height, row + 3); ++y) {
                for (int x = std::max(0, column - 2); x < std::min(paths.width, column + 3); ++x) {
                    sum += grey(paths.radiance, static_cast<std::size_t>(y * paths.width + x));
                    ++count;
                }
            }
            const auto pixel = static_cast<std::size_t>(row * paths.width + column);
            const double about = std::max(sum / count, darkest);
            const double distance =
                std::abs(grey(cached.radiance, pixel) - grey(paths.radiance, pixel)) / about;
            const double noise =
                std::hypot(grey(paths.error, pixel), grey(cached.error, pixel)) / about;
            found.beyond = std::max(found.beyond, distance - 3 * noise);
            if (distance > found.distance) {
                found.distance = distance;
                found.column = column;
                found.row = row;
            }
        }
    }
    return found;
}

}  // namespace

int main(int argc, char** argv) {
    const auto numberOf = [&](int k, double otherwise) {
        return argc > k ? std::atof(argv[k]) : otherwise;
    };
    const int size = static_cast<int>(numberOf(1, 32)), paths = static_cast<int>(numberOf(2, 4000));
    CacheOptions options;
    options.fewestBounces = 2;
    options.rays = static_cast<int>(numberOf(3, options.rays));
    options.accuracy = numberOf(4, options.accuracy);
    fmt::print(
        "| scene | records | mean by paths | mean by records | difference | largest distance of "
        "a pixel | beyond the noise |\n|---|---|---|---|---|---|---|\n");
    const auto views = test::cacheViews(size);
    for (std::size_t k = 0; k < views.size(); ++k) {
        const test::CacheView& view = views[k];
        if (argc > 5 && std::stoul(argv[5]) != k + 1) continue;
        const PathPicture reference =
            tracePaths(*view.scene, view.camera, {.samples = paths, .fewestBounces = 2});
        RadianceCache cache(*view.scene, options);
        const CachedPicture taken = takePicture(cache, view.camera, {.samples = 256});
        const Largest worst = largest(reference, taken.picture);
        const double expected = mean(reference.radiance), found = mean(taken.picture.radiance);
        fmt::print("| {} | {} | {:.5f} | {:.5f} | {:+.2f} % | {:.1f} % at ({}, {}) | {:.1f} % |\n",
                   view.name, taken.made, expected, found, 100 * (found / expected - 1),
                   100 * worst.distance, worst.column, worst.row, 100 * worst.beyond);
        std::fflush(stdout);
    }
    return 0;
}
