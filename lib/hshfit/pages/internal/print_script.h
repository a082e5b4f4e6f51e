#pragma once

// A figure for print as fields of a script of gnuplot, alone or on the page of a document.

#include <hshfit/files/template_text.h>
#include <hshfit/pages/print_figure.h>

#include <cstddef>

namespace hshfit::inline pages {

/// The place of a figure on a page, in points from the lower left corner; the page is as large as
/// the figure where no width is given.
struct FigureFrame {
    double left = 0, bottom = 0, pageWidth = 0, pageHeight = 0;
};

/// The fields of templates/figure_space.gp and figure_panels.gp; `index` is the N of csvN, the
/// variable that names its CSV file.
kainjow::mustache::data figureFields(const PrintFigure& figure, const FigureStyle& style,
                                     std::size_t index, const FigureFrame& frame = {});

/// Both templates, under the names "figureSpace" and "figurePanels".
void addFigureTemplates(kainjow::mustache::data& fields);

/// A number as scripts have it.
std::string scriptNumber(double value);

}  // namespace hshfit::inline pages
