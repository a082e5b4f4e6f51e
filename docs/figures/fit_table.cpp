// fit_table FOLDER [MODEL-NUMBER]: fits of models to the MERL slices of a folder next to published
// parameters, both by the loss that was minimised, over the same samples. A line per material and
// model: "MODEL MATERIAL LOSS OURS PUBLISHED CONVERGED"; docs/fit.md shows them.
#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/preset_collection.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

struct Row {
    std::string model, published;
    std::string_view loss;
    bool perChannel = false;
};

const Row rows[] = {
    {"ward", "ngan-ward", "cosine"},
    {"cook-torrance:norm=pi2,fresnel=schlick", "ngan-cook-torrance", "cosine"},
    {"cook-torrance", "low-cook-torrance-e1", "cosine"},
    {"cook-torrance", "low-cook-torrance-e2", "log"},
    {"abc:variant=smooth", "low-abc-smooth-e2", "log"},
    {"abc:variant=microfacet", "low-abc-microfacet-e2", "log"},
    {"ggx", "", "cosine"},
    {"ggx", "", "log"},
    {"sgd", "bagher-sgd", "log", true},
};

std::string publishedSpec(const std::string& collection, const std::string& material) {
    const auto index = findPresetCollection(collection);
    if (!index) return {};
    const auto* found = findMaterial(presetCollection(*index), material);
    return found ? found->spec : "";
}

void fitAll(const std::string& folder, const Row& row) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".slice") files.push_back(entry.path());
    std::ranges::sort(files);
    for (const auto& file : files) {
        const std::string material = file.stem().string();
        const FitSamples samples = gatherSamples(*open(file.string()), {});
        FitOptions options;
        options.model = row.model;
        options.loss = findLoss(row.loss).kind;
        options.perChannel = row.perChannel;
        const FitResult result = fit(samples, options);
        const std::string spec = publishedSpec(row.published, material);
        const std::string published =
            spec.empty() ? "-" : fmt::format("{:.6g}", lossOf(*open(spec), samples, options.loss));
        fmt::print("{} {} {} {:.6g} {} {}\n", row.model, material, row.loss,
                   lossOf(*open(result.spec), samples, options.loss), published,
                   result.converged ? "converged" : "not-converged");
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        fmt::print(stderr, "usage: fit_table FOLDER [MODEL-NUMBER]\n");
        return 2;
    }
    for (std::size_t i = 0; i < std::size(rows); ++i)
        if (argc == 2 || std::atoi(argv[2]) == static_cast<int>(i)) fitAll(argv[1], rows[i]);
}
