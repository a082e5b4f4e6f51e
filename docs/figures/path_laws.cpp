// path_laws PATHS [box|cornell|furnace|bias] [MESHES]: the laws of docs/results/illumination.md
// that path tracing is held to, measured at length: light in a box, and in the Cornell box of the
// folder MESHES, by bounce against radiosity with exact form factors, a white scene in a furnace,
// and the scatter of runs against one long run. Prints the rows of its tables.

#include <lib/transport/box_radiosity.h>
#include <lib/transport/cornell_radiosity.h>
#include <lib/transport/law_scenes.h>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

using namespace hshfit;

void printBox(int paths) {
    constexpr int bounces = 5;
    const char* names[] = {"floor", "ceiling", "back", "left", "right"};
    const SurfaceScene scene = test::boxScene();
    const auto coarse = test::radianceByBounce(8, bounces),
               fine = test::radianceByBounce(16, bounces);
    fmt::print(
        "| bounce | wall | radiosity (R) | its last step | paths (R) | largest |difference| "
        "of R, G, B in standard errors |\n|---|---|---|---|---|---|\n");
    constexpr std::size_t count = 5 * bounces;
    std::vector<PathEstimate> found(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        found[k] = test::tracedRadiance(scene, k % 5, static_cast<int>(k / 5) + 1, paths);
    });
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t bounce = k / 5 + 1, wall = k % 5;
        double largest = 0, step = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double expected = fine[bounce][wall][c];
            // Errors of patches fall with the square of their size.
            const double better = expected + (expected - coarse[bounce][wall][c]) / 3;
            largest = std::max(largest, std::abs(found[k].radiance[c] - better) /
                                            std::max(found[k].error[c], 1e-300));
            step = std::max(step, std::abs(expected / coarse[bounce][wall][c] - 1));
        }
        if (bounce == 1 && wall == test::ceiling) continue;  // in the lamp's plane
        fmt::print("| {} | {} | {:.5f} | {:.1e} | {:.5f} ± {:.5f} | {:.1f} |\n", bounce,
                   names[wall], fine[bounce][wall][0], step, found[k].radiance[0],
                   found[k].error[0], largest);
    }
}

void printCornell(int paths, const std::string& folder) {
    constexpr int bounces = 5;
    const test::CornellBox box(folder);
    const SurfaceScene scene = box.scene();
    const auto coarse = box.radianceByBounce(12, bounces), fine = box.radianceByBounce(24, bounces);
    constexpr std::size_t count = test::CornellBox::lamp * bounces;
    std::vector<PathEstimate> found(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        found[k] = box.traced(scene, k % test::CornellBox::lamp,
                              static_cast<int>(k / test::CornellBox::lamp) + 1, paths);
    });
    fmt::print(
        "\n| bounce | object | radiosity, G | its last step | paths, G | difference over the last "
        "step and three standard errors, largest of R, G, B |\n|---|---|---|---|---|---|\n");
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t bounce = k / test::CornellBox::lamp + 1,
                          object = k % test::CornellBox::lamp;
        if (bounce == 1 && object == 1) continue;  // above the lamp
        const double expected = fine[bounce][object][1];
        double share = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double radiosity = fine[bounce][object][c];
            share = std::max(share, std::abs(found[k].radiance[c] - radiosity) /
                                        (3 * found[k].error[c] +
                                         std::abs(radiosity - coarse[bounce][object][c])));
        }
        fmt::print("| {} | {} | {:.6f} | {:.1e} | {:.6f} ± {:.6f} | {:.2f} |\n", bounce,
                   test::CornellBox::names[object], expected,
                   std::abs(expected / coarse[bounce][object][1] - 1), found[k].radiance[1],
                   found[k].error[1], share);
    }
}

void printFurnace(int paths, bool flat) {
    const auto scene = test::whiteFurnace(flat);
    const Camera camera{.name = "eye", .position = {4, 2, 2}, .width = 4, .height = 4};
    const PathPicture found = tracePaths(*scene, camera, {.samples = paths});
    double off = 0, error = 0;
    for (std::size_t k = 0; k < found.radiance.size(); ++k) {
        off = std::max(off, std::abs(double{found.radiance[k]} - 1));
        error = std::max(error, double{found.error[k]});
    }
    fmt::print(
        "\nfurnace, {} normals: {} paths a pixel, largest |L - 1| {:.1e}, largest standard error "
        "{:.1e}\n",
        flat ? "flat" : "interpolated", paths, off, error);
}

void printBias() {
    const auto scene = test::glossyBall();
    constexpr int directions = 240, runs = 1000, samples = 16;
    std::vector<double> z(directions);
    tbb::parallel_for(0, directions, [&](int k) {
        z[static_cast<std::size_t>(k)] = test::biasTrial(
            *scene, normalised({-4, -1.2 + 0.01 * k, -1 + 0.3 * (k % 5 - 2)}), runs, samples, k);
    });
    // Directions that meet only the sky have no scatter.
    std::erase(z, 0.0);
    double sum = 0, squares = 0, largest = 0;
    for (const double value : z) {
        sum += value / static_cast<double>(z.size());
        squares += value * value / static_cast<double>(z.size());
        largest = std::max(largest, std::abs(value));
    }
    fmt::print(
        "bias: {} directions, {} runs of {} paths against one of {}: mean {:.2f}, root mean "
        "square {:.2f}, largest {:.1f} standard errors\n",
        z.size(), runs, samples, samples * runs, sum, std::sqrt(squares), largest);
}

}  // namespace

int main(int count, char** words) {
    const int paths = count > 1 ? static_cast<int>(std::atof(words[1])) : 100000;
    const std::string only = count > 2 ? words[2] : "";
    if (only.empty() || only == "box") printBox(paths);
    if (only == "cornell") {
        if (count < 4) {
            fmt::print(stderr, "path_laws: 'cornell' needs the folder of the meshes\n");
            return 2;
        }
        printCornell(paths, words[3]);
    }
    if (only.empty() || only == "furnace")
        for (const bool flat : {true, false}) printFurnace(16 * paths, flat);
    if (only.empty() || only == "bias") printBias();
}
