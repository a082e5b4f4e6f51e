#pragma once

// Figures for print, of fit() and compare().

#include "module.h"

#include <jobs/fits/figures.h>

#include <optional>
#include <string>

namespace hshfit::python {

/// The folder of figures and their look, as the program's --figures, --figure-width, --font,
/// --font-size, --axis and --panels; none without a folder. Throws UsageError for a value that
/// makes no figure.
std::optional<jobs::FigureOptions> figuresFrom(const py::object& folder, const std::string& width,
                                               const std::string& font, double fontSize,
                                               const std::string& axis, const std::string& panels);

/// Defaults of these arguments.
inline constexpr const char* figureWidth = "column";
inline constexpr const char* figureAxis = "auto";

}  // namespace hshfit::python
