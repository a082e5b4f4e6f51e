#include <hshfit/files/printable.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/internal/document_layout.h>
#include <hshfit/pages/internal/print_script.h>
#include <hshfit/pages/print_document.h>

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

namespace hshfit::embedded {
extern const std::string_view document_gp;
}

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

using kainjow::mustache::data;

std::string at(double x, double y) {
    return fmt::format("screen {}, screen {}", scriptNumber(x / PaperSize::width),
                       scriptNumber(y / PaperSize::height));
}

std::string statementOf(const PlacedText& text) {
    const std::string_view side = text.side == PlacedText::Side::left    ? "left"
                                  : text.side == PlacedText::Side::right ? "right"
                                                                         : "center";
    return fmt::format("set label {} at {} {} noenhanced font '{}{},{}' textcolor rgb '{}'",
                       gnuplotString(printable(text.text)), at(text.x, text.y), side,
                       text.code ? "monospace" : defaultFigureFont, text.bold ? ":Bold" : "",
                       scriptNumber(text.size), text.soft ? "#555555" : "#000000");
}

std::string statementOf(const PlacedRule& rule) {
    return fmt::format("set arrow from {} to {} nohead linecolor rgb '#777777' linewidth {}",
                       at(rule.left, rule.y), at(rule.right, rule.y), scriptNumber(rule.width));
}

/// The fields of a page; `figures` gets the figures that it shows, whose numbers go on from before.
data fieldsOf(const DocumentPage& page, const FigureStyle& style,
              std::vector<const PrintFigure*>& figures) {
    data fields, statements{data::type::list}, shown{data::type::list};
    for (const PlacedRule& rule : page.rules)
        statements.push_back(data("statement", statementOf(rule)));
    for (const PlacedText& text : page.texts)
        statements.push_back(data("statement", statementOf(text)));
    for (const PlacedFigure& placed : page.figures) {
        figures.push_back(placed.figure);
        shown.push_back(
            figureFields(*placed.figure, style, figures.size(),
                         {placed.left, placed.bottom, PaperSize::width, PaperSize::height}));
    }
    fields.set("statements", statements);
    fields.set("figures", shown);
    return fields;
}

}  // namespace

void addDocument(const PrintDocument& document, const std::string& name, FileSet& files) {
    constexpr double centimetre = 72 / 2.54;
    const FigureStyle style{.width = documentWidth};
    const std::vector<DocumentPage> laid = pagesOf(document, style);
    data fields, pages{data::type::list};
    std::vector<const PrintFigure*> figures;
    for (const DocumentPage& page : laid) pages.push_back(fieldsOf(page, style, figures));
    fields.set("font", std::string(defaultFigureFont));
    fields.set("fontSize", scriptNumber(style.fontSize));
    fields.set("widthCm", scriptNumber(PaperSize::width / centimetre));
    fields.set("heightCm", scriptNumber(PaperSize::height / centimetre));
    fields.set("pages", pages);
    addFigureTemplates(fields);
    // The script and its data are files for the time of the drawing alone.
    std::vector<std::string> scratch;
    const auto write = [&](const std::string& end, const std::string& text) -> const AtomicFile& {
        scratch.push_back(name + end);
        return files.write(scratch.back(), text);
    };
    const AtomicFile& pdf = files.add(name);
    const auto clear = [&] {
        for (const std::string& file : scratch) files.remove(file);
    };
    try {
        std::string settings = gnuplotFile("pdf", pdf);
        for (std::size_t k = 0; k < figures.size(); ++k)
            settings += gnuplotFile(fmt::format("csv{}", k + 1),
                                    write(fmt::format(".{}.csv", k + 1), figureCsv(*figures[k])));
        const AtomicFile& script = write(".gp", filledPage(embedded::document_gp, fields));
        runGnuplot(files.folder().string(),
                   {"-e", settings, fs::absolute(script.temporaryPath()).string()},
                   {fs::absolute(pdf.temporaryPath()).string()});
    } catch (...) {
        clear();
        files.remove(name);
        throw;
    }
    clear();
}

}  // namespace hshfit::inline pages
