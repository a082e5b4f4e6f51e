#pragma once

// Places of the parts of a document on its pages.

#include <hshfit/pages/print_document.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::inline pages {

/// A4 with margins of 20 mm, in points.
struct PaperSize {
    static constexpr double width = 595.28, height = 841.89, margin = 56.69;
    static constexpr double inner = width - 2 * margin;
};

/// A line of text at points from the lower left corner of its page.
struct PlacedText {
    enum class Side { left, right, centre };
    double x = 0, y = 0, size = 9;
    std::string text;
    Side side = Side::left;
    bool bold = false, soft = false, code = false;
};

struct PlacedRule {
    double left = 0, right = 0, y = 0, width = 0.5;
};

struct PlacedFigure {
    const PrintFigure* figure = nullptr;
    double left = 0, bottom = 0;
};

struct DocumentPage {
    std::vector<PlacedText> texts;
    std::vector<PlacedRule> rules;
    std::vector<PlacedFigure> figures;
};

/// The pages, each with its footer. `document` has to outlive them.
std::vector<DocumentPage> pagesOf(const PrintDocument& document, const FigureStyle& style);

/// The text in lines that are at most so many sizes of the font wide: broken at blanks, or within a
/// word that is longer; a line feed begins a new one.
std::vector<std::string> brokenLines(const std::string& text, double width);

}  // namespace hshfit::inline pages
