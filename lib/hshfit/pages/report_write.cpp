#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>

#include <filesystem>
#include <optional>

#include <fmt/format.h>

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

/// Draws from files of the set that are closed but not yet in place.
class Drawing {
public:
    Drawing(FileSet& files, const AtomicFile& script, const AtomicFile& csv)
        : files_(files),
          script_(fs::absolute(script.temporaryPath()).string()),
          data_(gnuplotFile("csv", csv)) {}

    void drawWhole() const {
        AtomicFile &svg = files_.add("curves.svg"), &pdf = files_.add("curves.pdf");
        try {
            run(gnuplotFile("svg", svg) + gnuplotFile("pdf", pdf), {&svg, &pdf});
        } catch (...) {
            for (const char* name : {"curves.svg", "curves.pdf"}) files_.remove(name);
            throw;
        }
    }

    /// One SVG document for each BRDF, through a temporary that is never committed.
    std::vector<std::string> drawForPage(std::size_t count) const {
        std::vector<std::string> figures;
        for (std::size_t i = 1; i <= count; ++i) {
            const AtomicFile svg((files_.folder() / "figure.svg").string());
            run(fmt::format("first={0}; last={0}; {1}pdf=''", i, gnuplotFile("svg", svg)), {&svg});
            figures.push_back(fileContent(svg.temporaryPath()));
        }
        return figures;
    }

private:
    void run(const std::string& settings, std::initializer_list<const AtomicFile*> drawn) const {
        std::vector<std::string> outputs;
        for (const AtomicFile* file : drawn) {
            outputs.push_back(fs::absolute(file->temporaryPath()).string());
        }
        runGnuplot(files_.folder().string(), {"-e", data_ + settings, script_}, outputs);
    }

    FileSet& files_;
    std::string script_, data_;
};

}  // namespace

void writeReport(const Report& report, const std::string& folder) {
    FileSet files(folder, true, FileSet::Above::require);
    files.write("report.json", reportJson(report));
    const AtomicFile& csv = files.write("curves.csv", reportCsv(report));
    const AtomicFile& script = files.write("curves.gp", reportScript(report));
    const Drawing drawing(files, script, csv);
    std::optional<NoFigures> undrawn;
    std::vector<std::string> figures;
    try {
        if (!report.reports.empty()) drawing.drawWhole();
        figures = drawing.drawForPage(report.reports.size());
    } catch (const NoFigures& error) {
        undrawn = error;
        figures.clear();
    }
    files.write("report.html", reportPage(report, figures));
    files.commit();
    if (undrawn) throw NoFigures(*undrawn);
}

}  // namespace hshfit::inline pages
