#include "figure_arguments.h"

#include "arrays.h"

namespace hshfit::python {

std::optional<jobs::FigureOptions> figuresFrom(const py::object& folder, const std::string& width,
                                               const std::string& font, double fontSize,
                                               const std::string& axis, const std::string& panels) {
    if (folder.is_none()) return std::nullopt;
    jobs::FigureOptions options{.folder = pathOf(folder, "figures"),
                                .style = {.width = parseFigureWidth(width),
                                          .font = font,
                                          .fontSize = fontSize,
                                          .axis = findFigureAxis(axis)},
                                .panels = panels};
    jobs::checkFigures(options);
    return options;
}

}  // namespace hshfit::python
