#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/internal/comparison_files.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <utility>

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

/// All figures, drawn to files of the set from others that are closed but not yet in place.
std::vector<std::string> drawFigures(const Comparison& comparison, const std::string& data,
                                     const AtomicFile& script, FileSet& files) {
    std::string names = data;
    std::vector<std::string> outputs, figures;
    const auto drawn = figuresOf(comparison);
    try {
        for (const auto& figure : drawn) {
            const AtomicFile& file = files.add(figure.file);
            outputs.push_back(fs::absolute(file.temporaryPath()).string());
            names += gnuplotFile(fmt::format("svg{}", outputs.size()), file);
        }
        runGnuplot(files.folder().string(),
                   {"-e", names, fs::absolute(script.temporaryPath()).string()}, outputs);
    } catch (...) {
        for (const auto& figure : drawn) files.remove(figure.file);
        throw;
    }
    for (const std::string& output : outputs) figures.push_back(fileContent(output));
    return figures;
}

}  // namespace

AddedComparison addComparison(const Comparison& comparison, FileSet& files,
                              const std::string& opening) {
    const std::array spheres{comparison.referenceSphere, comparison.approximationSphere,
                             amplified(comparison.difference, comparison.amplification)};
    const std::array linear{comparison.referenceSphere, comparison.approximationSphere,
                            comparison.difference};
    const std::string png = spheresPng(spheres, comparison.stops);
    AddedComparison added;
    std::string data;
    const auto write = [&](const std::string& name, const std::string& content,
                           const char* variable = nullptr) -> const AtomicFile& {
        const AtomicFile& file = files.write(name, content);
        added.names.push_back(name);
        if (variable) data += gnuplotFile(variable, file);
        return file;
    };
    write("comparison.json", comparisonJson(comparison));
    write("polar.csv", polarCsv(comparison), "polarCsv");
    write("half.csv", halfCsv(comparison), "halfCsv");
    write("residual.csv", residualCsv(comparison), "residualCsv");
    write("albedo.csv", albedoCsv(comparison), "albedoCsv");
    write("spheres.png", png);
    files.write("spheres.exr", [&](AtomicFile& file) {
        writeSpheres(linear, 0, file,
                     {{"hshfit:sphere1", comparison.reference.name},
                      {"hshfit:sphere2", comparison.approximation.name},
                      {"hshfit:sphere3", "sphere2 - sphere1"}});
    });
    added.names.emplace_back("spheres.exr");
    const AtomicFile& script = write("comparison.gp", comparisonScript(comparison));
    std::vector<std::string> figures;
    try {
        figures = drawFigures(comparison, data, script, files);
    } catch (const NoFigures& error) {
        added.undrawn = error.what();
    }
    for (std::size_t i = 0; i < figures.size(); ++i)
        added.names.push_back(figuresOf(comparison)[i].file);
    write("comparison.html", comparisonPage(comparison, figures, png, opening));
    return added;
}

namespace {

std::vector<std::string> writeTo(const Comparison& comparison, FileSet& files) {
    AddedComparison added = addComparison(comparison, files);
    files.commit();
    if (added.undrawn) throw NoFigures(*added.undrawn);
    return std::move(added.names);
}

}  // namespace

std::vector<std::string> writeComparison(const Comparison& comparison, const std::string& folder) {
    FileSet files(folder, true, FileSet::Above::require);
    return writeTo(comparison, files);
}

std::vector<std::string> writeComparison(const Brdf& reference, const Brdf& approximation,
                                         const ComparisonOptions& options,
                                         const std::string& folder) {
    FileSet files(folder, true, FileSet::Above::require);
    return writeTo(makeComparison(reference, approximation, options), files);
}

}  // namespace hshfit::inline pages
