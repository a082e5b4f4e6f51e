#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>
#include <jobs/source/quality.h>
#include "figures.h"
#include "fit_folder.h"

#include <brdfs/fit/choose_parts.h>
#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/percentiles.h>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct FitOptions {
    /// MODEL[:key=value,…][+MODEL…]; parameters with a value are held fixed.
    std::string model;
    /// brdfs::findLoss. Empty: l2 with stated uncertainties; for scattered samples cosine, or
    /// log-relative where they span more than brdfs::mostDecades; cosine where another option is
    /// about single samples (robust, weights, places, scans, budget, bootstrap, profile, residuals,
    /// bands); else picture, whose spheres look most like the data's.
    std::string loss = {};
    std::string robust = "none";   ///< brdfs::findRobust
    std::string weights = "auto";  ///< brdfs::findSampleWeights
    std::string places = "auto";   ///< brdfs::findSamplePlaces
    double robustScale = 0;        ///< residual at which `robust` sets in; 0: from their spread
    bool perChannel = false;       ///< separate shape parameters for each channel
    std::string dispersion = {};   ///< laws over the wavelength (brdfs::parseDispersion)
    int starts = 16;               ///< local searches
    int iterations = 200;          ///< at most, in the last search
    /// The time after which searches end where they are, not converged; none: no limit.
    std::optional<double> seconds = {};
    std::uint64_t seed = 1;  ///< of starts and drawn samples
    double grazingCut = brdfs::SampleOptions{}.grazingCut;
    std::size_t samples = 0;  ///< to draw; 0: all
    bool accept = false;      ///< accept a fit that did not converge
    bool rgb = false;         ///< wavelengths as linear Rec. 709
    /// Optional parts of the model (brdfs::ModelPart): "auto" for those that held-out directions
    /// find worth it, "none", "all", or names with commas. Empty: auto where the model has parts.
    std::string parts = {};
    std::string sigma = {};        ///< standard uncertainty of the samples: brdfs::parseSigma
    std::string scans = {};        ///< samples with correlated errors: brdfs::parseScans
    std::string calibration = {};  ///< common to all samples: brdfs::parseCalibration
    std::string budget = {};       ///< file of what is: brdfs::readContributions
    std::size_t bootstrap = 0;     ///< fits to resampled data; 0: none
    bool profile = false;          ///< intervals by profile likelihood
    std::string residuals = {};    ///< CSV file, a row for each value; empty: none
    std::optional<FigureOptions> figures = {};  ///< for print; none: not drawn
    brdfs::InstrumentText instrument = {};      ///< between f and the samples
    std::string bands = {};        ///< pairs at which f has its error (bandPairs); empty: none
    std::string bandsTo = {};      ///< CSV file of the bands; empty: in `Fitted::bands` alone
    std::string certificate = {};  ///< PDF (certificate.h); empty: none
    std::string certificateFields = {};  ///< readCertificateFields; empty: none is stated
    /// Where the fit is poor: try others in brief, for Fitted::poor.
    bool advise = true;
};
/// The options that a front end states, with options of its figures and of `instrument`.
OptionRows<FitOptions> fitOptions();
OptionRows<brdfs::InstrumentText> instrumentOptions();

/// The name of the loss that these options ask for with these data.
std::string lossOf(const FitOptions& options, const Brdf& data);

struct Fitted {
    brdfs::FitResult result;
    std::optional<brdfs::PartSearch> search = {};  ///< of a model with parts

    nlohmann::ordered_json preset;  ///< docs/schemas/fit.schema.json
    std::size_t pageFiles = 0;      ///< of the page, where one was asked for
    /// 1 - (loss / loss of a black surface)^2: the share of the data, in units of the loss. Of
    /// `picture` with the spread of the data about their mean in place of a black surface.
    double explained = 0;
    /// Root of the integral of ((fit - data) cos(theta_i))^2 over the integral of (data
    /// cos(theta_i))^2, over the samples; of `picture` over the nodes of a comparison.
    double relativeError = 0;
    std::optional<PictureError> picture = {};          ///< of the fit against the data
    std::optional<brdfs::SampleFactors> factors = {};  ///< of scattered samples
    std::optional<Poor> poor = {};  ///< the energy captured is 1 - relativeError^2
    FigureFiles figures = {};
    nlohmann::ordered_json bands = {};  ///< brdfs::bandRowsJson, where they were asked for
};

/// Whether `output` is a preset file rather than a folder with a preset and a page.
bool isPresetPath(const std::string& output);

/// Fits a model to a BRDF or a coefficient file. `output` is a preset (.json), a folder for the
/// preset and a page that compares fit and data, or empty for no file. Throws NumericError for
/// a fit that did not converge, unless it is accepted.
Fitted fit(const std::string& data, const std::string& output, const FitOptions& options,
           const Listener& listener = {});

/// Fits a model to a BRDF that is open, called `name` in messages and in the preset. Writes no
/// files but residuals, bands and figures.
Fitted fitBrdf(const Brdf& data, const std::string& name, const FitOptions& options,
               const Listener& listener = {});

/// The preset file of a fit.
std::string presetText(const Fitted& fitted);

/// Fits every file of a folder, each to RESULTS/NAME.EXTENSION.json. Existing results are kept.
BatchOutcome fitAll(const std::string& folder, const std::string& results,
                    const FitOptions& options, const Listener& listener = {});

struct RankedModels {
    std::string loss;
    std::vector<brdfs::ModelRank> models;
};

/// Fits every model to the same data and ranks them by error at held-out directions.
RankedModels rankModels(const std::string& data, const std::vector<std::string>& models,
                        const FitOptions& options);
RankedModels rankModels(const Brdf& data, const std::vector<std::string>& models,
                        const FitOptions& options);

}  // namespace hshfit::jobs
