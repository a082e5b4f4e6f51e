// Options of report, compare and convert.

#include "compare.h"
#include "convert.h"
#include "report.h"

#include <jobs/common/option_words.h>
#include <jobs/common/shared_options.h>

namespace hshfit::jobs {
namespace {

using options::at;

constexpr OptionRow reportRows[] = {
    OptionRow{"bases", at<&ReportOptions::bases>, "all, or names from hshfit list bases"}.takes(
        {basisLists, Syntax::list}),
    OptionRow{"max-order", at<&ReportOptions::maxOrder>, "Orders 1 to this one"}.within(
        bounds::curveOrders),
    OptionRow{"outgoing", at<&ReportOptions::outgoing>,
              "WxH, N or THETA,PHI in degrees (default: 16, or 16x16 if anisotropic)"}
        .takes({.syntax = Syntax::outgoing}),
    OptionRow{"wavelets", at<&ReportOptions::wavelets>,
              "A curve of SOHO wavelets too: the best n^2 terms of each outgoing direction"},
    rgbRow(at<&ReportOptions::rgb>),
    OptionRow{"cosine", at<&ReportOptions::cosine>, "Report f cos(theta_i) instead of f"},
    toleranceRow(at<&ReportOptions::tolerance>),
    evaluationsRow(at<&ReportOptions::maxEvaluations>),
};

constexpr OptionRow compareRows[] = {
    OptionRow{"metrics", at<&CompareOptions::metrics>, "all, or names from hshfit list metrics"}
        .takes({metricLists, Syntax::list}),
    OptionRow{"outgoing", at<&CompareOptions::outgoing>,
              "WxH, N or THETA,PHI (default: those of the coefficient file; else 16, or 16x16 if "
              "anisotropic)"}
        .takes({.syntax = Syntax::outgoing}),
    OptionRow{"sigma", at<&CompareOptions::sigma>,
              "Standard uncertainty of measured samples of A, for bars in the figures: 2%+0.001, "
              "column, or FILE.csv"}
        .takes(sigmaValues),
    rgbRow(at<&CompareOptions::rgb>),
};

constexpr OptionRow convertRows[] = {
    OptionRow{"to", at<&ConvertOptions::format>,
              "Format and its options, NAME[:key=value,...] (default: by the extension); `hshfit "
              "help formats` lists them"}
        .takes({.words = writerWords})
        .inPython("format"),
    OptionRow{"report-loss", at<&ConvertOptions::measureLoss>,
              "Read the file back and say what error it costs"}
        .inPython("measure_loss"),
    OptionRow{"outgoing", at<&ConvertOptions::outgoing>,
              "Outgoing directions of the loss: WxH, N or THETA,PHI"}
        .takes({.syntax = Syntax::outgoing})
        .with("report-loss"),
    OptionRow{"repair", at<&ConvertOptions::repairs>,
              "Repairs before writing, separated by commas, or all; `hshfit help formats` lists "
              "them"}
        .takes({repairWords, Syntax::list})
        .inPython("repairs"),
    rgbRow(at<&ConvertOptions::rgb>),
    OptionRow{"force", at<&ConvertOptions::force>, "Replace an existing file"},
};

}  // namespace

OptionRows<ReportOptions> reportOptions() {
    return {reportRows};
}

OptionRows<CompareOptions> compareOptions() {
    return {compareRows};
}

OptionRows<ConvertOptions> convertOptions() {
    return {convertRows};
}

}  // namespace hshfit::jobs
