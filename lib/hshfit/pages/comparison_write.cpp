#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/pages/comparison_files.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <optional>

#include <unistd.h>

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

/// All figures, drawn to temporaries and committed together.
std::vector<std::string> drawFigures(const Comparison& comparison, const std::string& folder) {
    std::vector<std::unique_ptr<AtomicFile>> files;
    std::string names;
    for (const auto& figure : figuresOf(comparison)) {
        files.push_back(std::make_unique<AtomicFile>(folder + "/" + figure.file));
        const auto path = fs::absolute(files.back()->temporaryPath()).string();
        names += fmt::format("svg{}={}; ", files.size(), gnuplotString(path));
    }
    runGnuplot(folder, {"-e", names, "comparison.gp"});
    std::vector<std::string> figures;
    for (const auto& file : files) figures.push_back(fileContent(file->temporaryPath()));
    for (const auto& file : files) file->commit();
    return figures;
}

/// A folder that was made for a comparison and goes again if nothing was written to it.
class MadeFolder {
public:
    explicit MadeFolder(const std::string& folder) : folder_(folder), made_(makeFolder(folder)) {}
    ~MadeFolder() {
        if (made_) ::rmdir(folder_.c_str());  // fails, as it should, where there are files
    }
    MadeFolder(const MadeFolder&) = delete;
    MadeFolder& operator=(const MadeFolder&) = delete;

private:
    std::string folder_;
    bool made_;
};

}  // namespace

std::vector<std::string> writeComparison(const Comparison& comparison, const std::string& folder) {
    const MadeFolder made(folder);
    const std::array spheres{comparison.referenceSphere, comparison.approximationSphere,
                             amplified(comparison.difference, comparison.amplification)};
    const std::array linear{comparison.referenceSphere, comparison.approximationSphere,
                            comparison.difference};
    const std::string png = spheresPng(spheres, comparison.stops);
    std::vector<std::string> names;
    const auto write = [&](const std::string& name, const std::string& content) {
        writeFile(folder + "/" + name, content);
        names.push_back(name);
    };
    write("comparison.json", comparisonJson(comparison));
    write("polar.csv", polarCsv(comparison));
    write("half.csv", halfCsv(comparison));
    write("residual.csv", residualCsv(comparison));
    write("albedo.csv", albedoCsv(comparison));
    write("spheres.png", png);
    writeSpheres(linear, 0, folder + "/spheres.exr",
                 {{"hshfit:sphere1", comparison.reference.name},
                  {"hshfit:sphere2", comparison.approximation.name},
                  {"hshfit:sphere3", "sphere2 - sphere1"}});
    names.emplace_back("spheres.exr");
    write("comparison.gp", comparisonScript(comparison));
    std::optional<OutputError> undrawn;
    std::vector<std::string> figures;
    try {
        figures = drawFigures(comparison, folder);
    } catch (const OutputError& error) {
        undrawn = error;
    }
    for (std::size_t i = 0; i < figures.size(); ++i) names.push_back(figuresOf(comparison)[i].file);
    write("comparison.html", comparisonPage(comparison, figures, png));
    if (undrawn) throw OutputError(*undrawn);
    return names;
}

std::vector<std::string> writeComparison(const Brdf& reference, const Brdf& approximation,
                                         const ComparisonOptions& options,
                                         const std::string& folder) {
    const MadeFolder made(folder);
    return writeComparison(makeComparison(reference, approximation, options), folder);
}

}  // namespace hshfit::inline pages
