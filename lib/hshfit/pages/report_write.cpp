#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>

#include <fmt/format.h>

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

/// Blanks the time at which cairo wrote a PDF; the length, and so the table of offsets, stays.
void removeCreationDate(const std::string& path) {
    const std::string pdf = fileContent(path);
    static const std::regex date(R"(/CreationDate \([^)]*\))");
    std::smatch match;
    if (!std::regex_search(pdf, match, date)) return;
    std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
    out.seekp(match.position());
    out << std::string(static_cast<std::size_t>(match.length()), ' ');
    out.close();
    if (!out) throw OutputError(fmt::format("cannot write '{}'", path));
}

std::vector<std::string> script(const std::string& settings) {
    return {"-e", settings, "curves.gp"};
}

std::string drawing(const AtomicFile& file) {
    return gnuplotString(fs::absolute(file.temporaryPath()).string());
}

void drawFigures(const std::string& folder) {
    AtomicFile svg(folder + "/curves.svg"), pdf(folder + "/curves.pdf");
    runGnuplot(folder, script(fmt::format("svg={}; pdf={}", drawing(svg), drawing(pdf))));
    removeCreationDate(pdf.temporaryPath());
    svg.commit();
    pdf.commit();
}

/// One SVG document for each BRDF, through a temporary that is never committed.
std::vector<std::string> figuresForPage(const std::string& folder, std::size_t count) {
    std::vector<std::string> figures;
    for (std::size_t i = 1; i <= count; ++i) {
        const AtomicFile svg(folder + "/figure.svg");
        runGnuplot(folder,
                   script(fmt::format("first={0}; last={0}; svg={1}; pdf=''", i, drawing(svg))));
        figures.push_back(fileContent(svg.temporaryPath()));
    }
    return figures;
}

}  // namespace

void writeReport(const Report& report, const std::string& folder) {
    makeFolder(folder);
    writeFile(folder + "/report.json", reportJson(report));
    writeFile(folder + "/curves.csv", reportCsv(report));
    writeFile(folder + "/curves.gp", reportScript(report));
    std::optional<OutputError> undrawn;
    std::vector<std::string> figures;
    try {
        if (!report.reports.empty()) drawFigures(folder);
        figures = figuresForPage(folder, report.reports.size());
    } catch (const OutputError& error) {
        undrawn = error;
        figures.clear();
    }
    writeFile(folder + "/report.html", reportPage(report, figures));
    if (undrawn) throw OutputError(*undrawn);
}

}  // namespace hshfit::inline pages
