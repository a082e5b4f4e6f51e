// Errors of presets against measured samples, and curves for figures:
//     preset_slices FOLDER                        a Markdown row per collection
//     preset_slices FOLDER curve MATERIAL [D]     theta_h, measured, each collection: green channel
//                                                 at difference angle D degrees (default 30)
//     preset_slices FOLDER wavelength             L2 distance of the ngan-he presets with heights
//                                                 below 0.3 by the wavelength assumed
// FOLDER holds MERL slices, NAME.slice.

#include "../../tests/brdfs/merl_slice.h"

#include <brdfs/catalog.h>
#include <brdfs/presets/preset_collection.h>

#include <fmt/format.h>

#include <cstdlib>
#include <exception>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

void printRow(const std::string& folder, std::size_t index) {
    const std::string name(presetCollections()[index].name);
    std::vector<double> errors, highlights, cubeRoots, biases[3];
    for (const auto& material : presetCollection(index).materials) {
        const auto slice = MerlSlice::read(folder, material.name);
        if (!slice) continue;
        const auto distance = slice->distance(*open("preset:" + name + "/" + material.name));
        for (int c = 0; c < 3; ++c) {
            errors.push_back(distance.error[c]);
            biases[c].push_back(distance.bias[c]);
        }
        highlights.push_back(distance.highlight);
        cubeRoots.push_back(distance.cubeRoot);
    }
    fmt::print("| `{}` | {} | {:.3f} | {:.3f} | {:+.3f} {:+.3f} {:+.3f} | {:.3f} |\n", name,
               cubeRoots.size(), MerlSlice::median(errors), MerlSlice::median(highlights),
               MerlSlice::median(biases[0]), MerlSlice::median(biases[1]),
               MerlSlice::median(biases[2]), MerlSlice::median(cubeRoots));
}

int printCurve(const std::string& folder, const std::string& material, int d) {
    const auto slice = MerlSlice::read(folder, material);
    if (!slice || d < 0 || d > 89) return 1;
    std::vector<std::unique_ptr<Brdf>> brdfs;
    fmt::print("# theta_h measured");
    for (std::size_t i = 0; i < presetCollections().size(); ++i)
        if (findMaterial(presetCollection(i), material)) {
            fmt::print(" {}", presetCollections()[i].name);
            brdfs.push_back(
                open(fmt::format("preset:{}/{}", presetCollections()[i].name, material)));
        }
    fmt::print("\n");
    for (int h = 0; h < 90; ++h) {
        fmt::print("{:.4f} {:.6g}", MerlSlice::thetaH(h) * 180 / pi, slice->value(d, h, 1));
        for (const auto& brdf : brdfs)
            fmt::print(" {:.6g}", MerlSlice::evaluateAt(*brdf, d, h)[brdf->channels().count() / 2]);
        fmt::print("\n");
    }
    return 0;
}

void printWavelengths(const std::string& folder) {
    const PresetCollection& collection = presetCollection(*findPresetCollection("ngan-he"));
    const std::string given = "wavelength=0.6";
    for (const double wavelength : {.3, .4, .5, .55, .6, .65, .7, .8, 1., 2.}) {
        std::vector<double> squares;
        for (const auto& [name, spec] : collection.materials) {
            const auto slice = MerlSlice::read(folder, name);
            const std::size_t sigma = spec.find("sigma=");
            if (!slice || std::stod(spec.substr(sigma + 6)) > .3) continue;
            std::string assumed = spec;
            assumed.replace(assumed.find(given), given.size(),
                            fmt::format("wavelength={}", wavelength));
            squares.push_back(slice->distance(*open(assumed)).squares);
        }
        fmt::print("| {} | {} | {:.3f} |\n", wavelength, squares.size(),
                   MerlSlice::median(squares));
    }
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 2) return 2;
    if (argc > 3) return printCurve(argv[1], argv[3], argc > 4 ? std::atoi(argv[4]) : 30);
    if (argc == 3) {
        printWavelengths(argv[1]);
        return 0;
    }
    for (std::size_t i = 0; i < presetCollections().size(); ++i) printRow(argv[1], i);
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
}
