#pragma once

// Documents of several pages for print: text, tables and figures below one another.

#include <hshfit/files/file_set.h>
#include <hshfit/pages/figure_style.h>
#include <hshfit/pages/print_figure.h>

#include <string>
#include <utility>
#include <vector>

namespace hshfit::inline pages {

/// A part of a document. Texts are shown as they are, broken into lines as wide as the page.
struct DocumentBlock {
    enum class Kind {
        title,
        heading,  ///< stays with the line below it
        text,
        code,   ///< like text, of characters of one width
        pairs,  ///< a name, and its text beside it
        table,  ///< with its head again on each page
        figure
    };
    Kind kind = Kind::text;
    std::string text = {};
    std::vector<std::pair<std::string, std::string>> pairs = {};
    std::string columns = {};  ///< 'l' or 'r' for each: the side on which its cells stand
    std::vector<std::string> heads = {};
    std::vector<std::vector<std::string>> rows = {};
    std::vector<PrintFigure> figures = {};
};

struct PrintDocument {
    std::string footer;  ///< of each page, with its number
    std::vector<DocumentBlock> blocks;
};

/// The width of figures on the page, mm.
inline constexpr double documentWidth = 170;

/// Adds a document of A4 pages, drawn by gnuplot, to a set under this name: a PDF that embeds its
/// fonts and has no date; the same document gives the same bytes. Throws NoFigures, and
/// OutputError where the file cannot be written; the set is then without it.
void addDocument(const PrintDocument& document, const std::string& name, FileSet& files);

}  // namespace hshfit::inline pages
