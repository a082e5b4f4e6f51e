#pragma once

#include <jobs/common/inputs.h>
#include <jobs/common/listener.h>
#include <jobs/source/quality.h>
#include <jobs/studies/form_options.h>

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/projection/projection.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct ProjectOptions {
    std::string basis = "hsh";
    int order = 7;
    /// OutgoingSet::parse; empty: 32 elevations if isotropic, else 32x32, or what the form needs.
    std::string outgoing;
    bool cosine = false;  ///< f cos(theta_i) instead of f
    bool condonShortley = false;
    bool rgb = false;      ///< wavelengths as linear Rec. 709
    double tolerance = 0;  ///< as in ProjectionOptions
    double maxEvaluations = static_cast<double>(ProjectionOptions{}.maxEvaluations);
    /// Least squares over the samples of a scattered measurement, without interpolation.
    bool leastSquares = false;
    double regularise = 1e-3;  ///< Tikhonov weight of least squares
    double kernel = 20;        ///< degrees about an outgoing direction that least squares uses
    /// The form in which coefficients are stored, with basis, order, quantity, sign and outgoing
    /// set as above.
    FormOptions form = {};
};
OptionRows<ProjectOptions> projectOptions();

/// A projection and, where a form was asked for, its representation in the file.
struct Projected {
    Projection projection;
    std::optional<Representation> kept = {};
    /// For the form halfway, as it is in the file: no quadrature tells how far it is from f.
    std::optional<PairSummary> errors = {};
    /// The share of the energy that is captured; none where that is not known.
    std::optional<double> captured = {};
    std::optional<PictureError> picture = {};  ///< pictureErrorOf
    std::string output;
    std::optional<Poor> poor = {};
    std::string remark = {};  ///< on the source: f is 0, or not reciprocal where the form is
};

/// Writes the coefficients of one BRDF to `output`, .json or .exr. Throws UsageError for
/// options that contradict each other or the BRDF, InputError, NumericError and OutputError.
Projected project(const std::string& spec, const std::string& output, const ProjectOptions& options,
                  const Listener& listener = {});

/// Projects a BRDF that is open, without a file; suggestions name `output` as the file.
Projected projectBrdf(const Brdf& brdf, const ProjectOptions& options,
                      const Listener& listener = {}, const std::string& output = {});
/// Writes the coefficients, in the form that they were projected to. Throws UsageError,
/// NumericError and OutputError as writeCoefficients and writeRepresentation do.
void writeProjected(const Projected& result, const std::string& path);

struct ManyProjected {
    std::vector<std::string> specs;  ///< with folders expanded
    /// In the order of `specs`; none where one failed. Coefficients are in the files alone.
    std::vector<std::optional<Projected>> results;
    std::vector<InputFailure> failures;
    std::vector<std::string> kept = {};  ///< files that stand and are valid; not in `specs`
};

/// Projects several BRDFs and folders, each to FOLDER/NAME.json or .exr (`extension`, with the
/// dot). The folder is created if it is absent. A failed BRDF does not stop the others. Files that
/// stand: kept_outputs.h.
ManyProjected projectMany(const std::vector<std::string>& specs, const std::string& folder,
                          const std::string& extension, const ProjectOptions& options,
                          const Listener& listener = {});

}  // namespace hshfit::jobs
