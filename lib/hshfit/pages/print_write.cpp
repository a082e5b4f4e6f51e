#include <hshfit/error.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/print_figure.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

struct DrawnFile {
    const AtomicFile* file;
    const PrintFigure* figure;
    bool pdf;
    std::string path() const { return fs::absolute(file->temporaryPath()).string(); }
};

/// Gives the root of an SVG document its size in mm; its own units stay points.
void stateSize(const DrawnFile& drawn, const FigureStyle& style) {
    const std::string path = drawn.path();
    std::string svg = fileContent(path);
    const std::size_t first = svg.find("width=\""), end = svg.find("viewBox");
    if (first == svg.npos || end == svg.npos || end < first)
        throw OutputError(fmt::format("{}: gnuplot wrote no size", drawn.file->path()));
    const auto [width, height] = figureSize(*drawn.figure, style);
    svg.replace(first, end - first,
                fmt::format("width=\"{:.6g}mm\" height=\"{:.6g}mm\"\n ", width, height));
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out << svg;
    out.close();
    if (!out) throw OutputError(fmt::format("{}: cannot be written", drawn.file->path()));
}

std::string lettersOf(std::string_view text) {
    std::string letters;
    for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

/// The first font of a PDF if none of them has the name that was asked for.
std::string substituteIn(const std::string& pdf, const std::string& asked) {
    constexpr std::array generic{"serif", "sansserif", "sans", "monospace", "mono"};
    const std::string wanted = lettersOf(asked);
    if (wanted.empty() || std::ranges::find(generic, wanted) != generic.end()) return {};
    constexpr std::string_view key = "/BaseFont /";
    std::string first;
    for (std::size_t at = pdf.find(key); at != pdf.npos; at = pdf.find(key, at)) {
        at += key.size();
        std::string name = pdf.substr(at, pdf.find_first_of(" \r\n/>", at) - at);
        // A subset of a font has six letters and a plus sign before its name.
        if (name.size() > 7 && name[6] == '+') name.erase(0, 7);
        if (lettersOf(name).starts_with(wanted)) return {};
        if (first.empty()) first = name;
    }
    return first;
}

/// Draws all figures to files of the set. Where that fails, the set is without them.
std::vector<DrawnFile> drawFigures(const std::vector<PrintFigure>& figures, const std::string& data,
                                   const AtomicFile& script, FileSet& files) {
    std::vector<DrawnFile> drawn;
    std::vector<std::string> names, outputs;
    std::string settings = data;
    try {
        for (std::size_t k = 0; k < figures.size(); ++k)
            for (const bool pdf : {true, false}) {
                names.push_back(figures[k].name + (pdf ? ".pdf" : ".svg"));
                drawn.push_back({&files.add(names.back()), &figures[k], pdf});
                outputs.push_back(drawn.back().path());
                settings += gnuplotFile(fmt::format("{}{}", pdf ? "pdf" : "svg", k + 1),
                                        *drawn.back().file);
            }
        runGnuplot(files.folder().string(),
                   {"-e", settings, fs::absolute(script.temporaryPath()).string()}, outputs);
    } catch (...) {
        for (std::size_t k = 0; k < drawn.size(); ++k) files.remove(names[k]);
        throw;
    }
    return drawn;
}

}  // namespace

AddedFigures addFigures(const std::vector<PrintFigure>& figures, const FigureStyle& style,
                        FileSet& files) {
    checkFigureStyle(style);
    AddedFigures added;
    std::string data;
    const auto write = [&](const std::string& name, const std::string& text) -> const AtomicFile& {
        added.names.push_back(name);
        return files.write(name, text);
    };
    for (std::size_t k = 0; k < figures.size(); ++k)
        data += gnuplotFile(fmt::format("csv{}", k + 1),
                            write(figures[k].name + ".csv", figureCsv(figures[k])));
    const AtomicFile& script = write("figures.gp", figuresScript(figures, style));
    try {
        for (const DrawnFile& drawn : drawFigures(figures, data, script, files)) {
            added.names.push_back(drawn.figure->name + (drawn.pdf ? ".pdf" : ".svg"));
            if (!drawn.pdf) {
                stateSize(drawn, style);
                added.svgs.push_back(fileContent(drawn.path()));
            } else if (added.font.empty()) {
                added.font = substituteIn(fileContent(drawn.path()), style.font);
            }
        }
    } catch (const NoFigures& error) {
        added.undrawn = error.what();
    }
    return added;
}

}  // namespace hshfit::inline pages
