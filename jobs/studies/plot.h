#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/pages/basis_figure.h>

#include <string>

namespace hshfit::jobs {

struct PlotOptions {
    int order = 4;        ///< bands to draw, or as many as the basis has
    bool sphere = false;  ///< the whole sphere in place of the hemisphere
    bool condonShortley = false;

    FigureDomain domain() const { return sphere ? FigureDomain::sphere : FigureDomain::hemisphere; }
};
OptionRows<PlotOptions> plotOptions();

struct Plotted {
    std::string basis;
    int order = 0, functions = 0;
};

/// The functions of a basis as a figure, .png, .svg or .pdf (writeBasisFigure). Throws UsageError,
/// NoFigures and OutputError.
Plotted plot(const std::string& basis, const std::string& output, const PlotOptions& options);

}  // namespace hshfit::jobs
