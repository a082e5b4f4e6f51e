// Our fits next to published ones, on the same samples in the same metric:
//     fit_slices FOLDER CSV [MODEL [MATERIAL [CUT]]]
// writes a row per collection, loss and material of FOLDER (MERL slices, NAME.slice, or whole
// tables, NAME.binary, of which 20,000 cells are drawn) to CSV, the summary in Markdown to stdout
// and progress to stderr. MODEL and MATERIAL keep those whose names hold them; samples with an
// angle beyond CUT degrees (80) are left out.

#include "../../tests/brdfs/fit_rivals.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <vector>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

struct Row {
    std::string material;
    Duel duel;
};

/// Slices and tables whose names hold `part`, in order.
std::vector<std::filesystem::path> filesIn(const std::string& folder, const std::string& part) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::filesystem::path& path = entry.path();
        if ((path.extension() == ".slice" || path.extension() == ".binary") &&
            path.stem().string().find(part) != std::string::npos)
            files.push_back(path);
    }
    std::ranges::sort(files);
    return files;
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

void printSummary(const Rival& rival, const std::vector<Row>& rows) {
    std::vector<double> ratios, published, ours;
    const Row* worst = nullptr;
    std::size_t better = 0, worse = 0, unsettled = 0;
    for (const Row& row : rows) {
        unsettled += !row.duel.fit.converged;
        if (!row.duel.published) continue;
        const double ratio = row.duel.ratio();
        better += ratio < 0.9;
        worse += ratio > 1;
        if (!worst || ratio > worst->duel.ratio()) worst = &row;
        ratios.push_back(ratio);
        published.push_back(*row.duel.published);
        ours.push_back(row.duel.ours);
    }
    if (!worst) return;
    fmt::print(
        "| `{}` | `{}` | {} | {} of {} | {:.4g} | {:.4g} | {:.3f} | {:.3f} {} | {} | {} | "
        "{} |\n",
        rival.collection, rival.model, lossName(rival.loss), ratios.size(), rows.size(),
        median(published), median(ours), median(ratios), worst->duel.ratio(), worst->material,
        better, worse, unsettled);
    std::fflush(stdout);
}

void writeRows(std::ofstream& file, const Rival& rival, const std::vector<Row>& rows) {
    for (const auto& [material, duel] : rows) {
        const std::string comparison =
            duel.published
                ? fmt::format("{:.6g},{:.6g},{:.5f}", *duel.published, duel.ours, duel.ratio())
                : fmt::format(",{:.6g},", duel.ours);
        file << fmt::format("{},{},{},{},{},{}\n", rival.collection,
                            rival.model.substr(0, rival.model.find(':')), lossName(rival.loss),
                            material, comparison, duel.fit.converged ? "yes" : "no");
    }
    file.flush();
}

void run(const std::string& folder, const std::string& path, const std::string& model,
         const std::string& material, double cut) {
    std::vector<std::string> materials;
    std::vector<FitSamples> samples;
    for (const std::filesystem::path& slice : filesIn(folder, material)) {
        materials.push_back(slice.stem().string());
        samples.push_back(samplesOfSlice(slice.string(), cut));
    }
    std::ofstream file(path);
    file << "collection,model,loss,material,published,ours,ratio,converged\n";
    fmt::print(
        "| published | fitted | loss | materials | their loss | ours | ratio | worst | over "
        "10 % better | worse | not converged |\n|{}\n",
        "---|---|---|---|---|---|---|---|---|---|---|");
    for (const Rival& rival : rivals) {
        if (rival.model.find(model) == std::string_view::npos) continue;
        std::vector<Row> rows(materials.size());
        std::atomic<std::size_t> done = 0;
        tbb::parallel_for(std::size_t{0}, materials.size(), [&](std::size_t i) {
            rows[i] = {materials[i], duel(rival, materials[i], samples[i])};
            fmt::print(stderr, "{}/{} {} {} {}: {:.1f} s\n", ++done, materials.size(), rival.model,
                       lossName(rival.loss), materials[i], rows[i].duel.seconds);
        });
        writeRows(file, rival, rows);
        printSummary(rival, rows);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 3 || argc > 6) return 2;
    run(argv[1], argv[2], argc > 3 ? argv[3] : "", argc > 4 ? argv[4] : "",
        argc > 5 ? std::atof(argv[5]) : 80);
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
}
