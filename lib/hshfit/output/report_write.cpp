#include <hshfit/error.h>
#include <hshfit/output/atomic_file.h>
#include <hshfit/output/gnuplot.h>
#include <hshfit/output/report_files.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

namespace hshfit {
namespace {

namespace fs = std::filesystem;

void makeFolder(const std::string& folder) {
    if (::mkdir(folder.c_str(), 0777) == 0) return;
    const int error = errno;
    if (error == EEXIST && fs::is_directory(folder)) return;
    throw OutputError(fmt::format("cannot make the folder '{}': {}", folder,
                                  std::generic_category().message(error)));
}

std::string contentOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Blanks the time at which cairo wrote a PDF; the length, and so the table of offsets, stays.
void removeCreationDate(const std::string& path) {
    const std::string pdf = contentOf(path);
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
        figures.push_back(contentOf(svg.temporaryPath()));
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

}  // namespace hshfit
