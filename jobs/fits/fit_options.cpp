#include "fit.h"

#include <jobs/common/option_words.h>
#include <jobs/common/shared_options.h>

namespace hshfit::jobs {
namespace {

using brdfs::InstrumentText;
using options::at;

std::vector<Word> robustWords() {
    return {{"none"}, {"huber"}, {"cauchy"}};
}

std::vector<Word> weightWords() {
    return {{"auto"}, {"equal"}, {"solid-angle"}};
}

std::vector<Word> placeWords() {
    return {{"auto"}, {"cells"}, {"nodes"}};
}

std::vector<Word> scanWords() {
    return {{"column", "of the file, or of that of the uncertainties"},
            {"incidence", "samples of one incident direction"}};
}

std::vector<Word> fittedWords() {
    return {{"fit", "found by the fit"}};
}

std::vector<Word> darkWords() {
    return {{"fit", "found by the fit, over the cosine of the outgoing direction"},
            {"fit:in", "of the incident direction"},
            {"fit:both", "of both"}};
}

constexpr Values textFile{.files = Files::read, .dash = ".csv"};

constexpr OptionRow fitRows[] = {
    OptionRow{"model", at<&FitOptions::model>,
              "MODEL[:key=value,...][+MODEL...]: what is given is not fitted"}
        .takes({modelWords, Syntax::sum}),
    OptionRow{"extensions", at<&FitOptions::parts>,
              "Of gltf-pbr and openpbr: auto (default) for the optional parts that pixels or "
              "held-out directions find worth it, none, all, or names with commas"}
        .takes({.syntax = Syntax::list})
        .inPython("parts"),
    OptionRow{"loss", at<&FitOptions::loss>,
              "picture (default for functions and tables), l2 (default with --sigma), cosine "
              "(default for scattered samples), log-relative (default for those that span more "
              "than two decades), log or cube-root"}
        .takes({.words = lossWords}),
    OptionRow{"robust", at<&FitOptions::robust>, "none, huber or cauchy"}.takes(
        {.words = robustWords}),
    OptionRow{"robust-scale", at<&FitOptions::robustScale>,
              "Residual at which it sets in; 0: from the residuals' spread"}
        .within(bounds::robustScale),
    OptionRow{"per-channel", at<&FitOptions::perChannel>, "Shapes of their own for each channel"},
    OptionRow{"dispersion", at<&FitOptions::dispersion>,
              "Of spectra: PARAMETER=LAW[:N][,...], laws over the wavelength in place of a value "
              "at each; cauchy, sellmeier, poly, spline, shared or free"},
    OptionRow{"weights", at<&FitOptions::weights>, "auto, equal or solid-angle"}.takes(
        {.words = weightWords}),
    OptionRow{"at", at<&FitOptions::places>,
              "Places of samples: auto, cells of a table, or nodes of the quadrature by which "
              "BRDFs are compared"}
        .takes({.words = placeWords}),
    OptionRow{"grazing-cut", at<&FitOptions::grazingCut>,
              "Leave out samples with a polar angle above this, degrees"}
        .within(bounds::grazingCut),
    OptionRow{"samples", at<&FitOptions::samples>, "Draw so many samples; 0: all"},
    OptionRow{"starts", at<&FitOptions::starts>, "Local searches"}.within(bounds::starts),
    OptionRow{"iterations", at<&FitOptions::iterations>, "At most so many in the last search"}
        .within(bounds::iterations),
    OptionRow{"seconds", at<&FitOptions::seconds>,
              "End the searches after that time where they are, not converged; with --accept the "
              "best point so far is the fit"}
        .within(bounds::seconds),
    OptionRow{"seed", at<&FitOptions::seed>, "Of starts and drawn samples"},
    OptionRow{"sigma", at<&FitOptions::sigma>,
              "Standard uncertainty of a sample: 2%+0.001 (relative and absolute, in squares), "
              "column, or FILE.csv with a row for each sample; behind it "
              ",correlation:angle=3deg,wavelength=20nm or ,covariance=FILE where errors are "
              "correlated"}
        .takes(sigmaValues),
    OptionRow{"calibration", at<&FitOptions::calibration>,
              "Relative standard uncertainty of a calibration common to all samples: 0.8%"},
    OptionRow{"budget", at<&FitOptions::budget>,
              "JSON or CSV file of uncertainties common to all samples: name, on (scale, "
              "linearity, offset, dark, incidence, detector), half_width or "
              "standard_uncertainty, ..."}
        .takes({.files = Files::read, .dash = ""}),
    OptionRow{"scans", at<&FitOptions::scans>,
              "Samples with correlated errors: column, incidence, or so many after one another"}
        .takes({.words = scanWords}),
    OptionRow{"bootstrap", at<&FitOptions::bootstrap>,
              "Errors by so many fits to samples, or scans, drawn with replacement"}
        .within(Bounds<int>{2, 1000000}),
    OptionRow{"profile", at<&FitOptions::profile>,
              "Intervals of 68 and 95 % by profile likelihood"},
    OptionRow{"residuals", at<&FitOptions::residuals>,
              "CSV file with a row for each value: model, residual, leverage, ..."}
        .takes({.files = Files::written, .dash = ".csv"}),
    OptionRow{"bands", at<&FitOptions::bands>,
              "Standard errors and bands of the fitted f at pairs of directions: a CSV with wi_x "
              "... wo_z, or plane:30/60 for planes of incidence"}
        .takes(textFile),
    OptionRow{"bands-to", at<&FitOptions::bandsTo>, "CSV file for the bands"}.takes(
        {.files = Files::written, .dash = ".csv"}),
    OptionRow{"certificate", at<&FitOptions::certificate>,
              "PDF for a laboratory to sign: parameters, f and radiance factor with expanded "
              "uncertainties, budget, figures, hashes"}
        .takes({.files = Files::written, .dash = ".pdf"}),
    OptionRow{"certificate-fields", at<&FitOptions::certificateFields>,
              "JSON file of its texts: certificate, laboratory, date, client, sample, instrument, "
              "geometry, standard, traceability, conditions, method, remarks, operator, "
              "approved_by"}
        .takes({.files = Files::read, .dash = ".json"}),
    OptionRow{"accept", at<&FitOptions::accept>, "Take a fit that did not converge"},
    rgbRow(at<&FitOptions::rgb>),
};

constexpr OptionRow instrumentRows[] = {
    OptionRow{"source-aperture", at<&InstrumentText::source>,
              "Directions of the source about the nominal one: cone:HALF or rectangle:HALFxHALF "
              "(along the polar angle, across), degrees"},
    OptionRow{"detector-aperture", at<&InstrumentText::detector>,
              "Directions of the detector, likewise"},
    OptionRow{"aperture-tolerance", at<&InstrumentText::tolerance>,
              "Relative error of averages over apertures"},
    OptionRow{"bandwidth", at<&InstrumentText::bandwidth>,
              "Slit of data with wavelengths: box:NM, triangle:NM or gauss:NM, full width at half "
              "maximum"},
    OptionRow{"offset", at<&InstrumentText::offset>,
              "What the instrument adds to f, 1/sr: a number, or fit"}
        .takes({.words = fittedWords}),
    OptionRow{"dark", at<&InstrumentText::dark>,
              "The same over a cosine by which readings are divided: a number, or fit, with :out "
              "(default), :in or :both"}
        .takes({.words = darkWords}),
    OptionRow{"stray", at<&InstrumentText::stray>,
              "Share of light that reaches the detector from all of the hemisphere: a number, or "
              "fit"}
        .takes({.words = fittedWords}),
    OptionRow{"scan-scale", at<&InstrumentText::scale>,
              "A scale for each of the --scans: the standard deviation about 1 that is expected "
              "(2%), or fit, relative to the first"}
        .takes({.words = fittedWords}),
    OptionRow{"incidence-zero", at<&InstrumentText::incidenceZero>,
              "The zero of the angle of incidence is fitted: its standard uncertainty in degrees, "
              "with :scan for one for each of the --scans (0.05:scan)"},
    OptionRow{"detector-zero", at<&InstrumentText::detectorZero>,
              "The zero of the detector's angle, likewise"},
};

}  // namespace

OptionRows<FitOptions> fitOptions() {
    return {fitRows};
}

OptionRows<InstrumentText> instrumentOptions() {
    return {instrumentRows};
}

}  // namespace hshfit::jobs
