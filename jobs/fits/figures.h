#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/files/file_set.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pages/figure_style.h>
#include <hshfit/pages/print_figure.h>

#include <brdfs/fit/fit_json.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Figures for print of a fit or a comparison.
struct FigureOptions {
    std::string folder = {};  ///< made if absent
    FigureStyle style = {};
    std::string panels = "auto";  ///< brdfs::chosenCuts
};

/// FigureOptions as words of a command line; `figures` is the folder.
struct FigureArguments {
    std::string figures = {}, figureWidth = "column", font = std::string(defaultFigureFont),
                fontSize = "8", axis = "auto", panels = "auto";

    /// None without a folder. Throws UsageError for a value that makes no figure, and for a look
    /// without a folder.
    std::optional<FigureOptions> parsed() const;
};
OptionRows<FigureArguments> figureOptions();

/// Throws UsageError for options that make no figure, before the work.
void checkFigures(const FigureOptions& options);

/// Figures that were written, or are to be.
struct FigureFiles {
    std::vector<std::string> names;  ///< in the folder
    std::size_t samples = 0;         ///< measured ones that stand in a panel of cuts
    std::size_t inPlane = 0;         ///< those in any plane of incidence
    std::size_t all = 0;             ///< measured samples; 0: the data are none
    std::size_t panels = 0;
    std::string font = {};  ///< AddedFigures
    std::optional<std::string> undrawn = {};
    std::vector<std::string> svgs = {};  ///< documents of the .svg among `names`, in their order
    std::vector<std::vector<int>> columns = {};  ///< figureColumns of each
};

/// The figures of a fit, with bands of 95 %, under temporary names in `files` until it is
/// committed: cuts, polar, residuals and spectrum of measured samples (fit_figures.h), with
/// samples.csv, their residuals (residual_rows.h) unless the kernel is robust; of other data the
/// plots of a comparison with the fit, and residuals at its samples. parameters.tex is its table.
FigureFiles addFitFigures(const Brdf& data, const brdfs::FitReport& report,
                          const FigureOptions& options, FileSet& files,
                          const Listener& listener = {});

/// The figures of a fit for its page, as wide as a page: of measured samples cuts and spectrum, and
/// residuals, correlations and influence, with parameters.tex and samples.csv likewise.
FigureFiles addPageFigures(const brdfs::FitReport& report, FileSet& files);
/// The figures of addPageFigures before they are drawn.
std::vector<PrintFigure> pageFigures(const brdfs::FitReport& report, const FigureStyle& style);

/// The figures of a comparison, likewise: its plots, and of measured samples as the reference cuts,
/// polar and residuals too, with the uncertainties that `sigma` states (brdfs::parseSigma).
FigureFiles addComparisonFigures(const Comparison& comparison, const Brdf& reference,
                                 const Brdf& approximation, const std::string& sigma,
                                 const FigureOptions& options, FileSet& files);

}  // namespace hshfit::jobs
