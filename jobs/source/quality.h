#pragma once

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/projection/projection.h>
#include <hshfit/representation/representation.h>
#include <hshfit/wording.h>

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// A result that is poor (pictures/poor.h): what is wrong with it, and the call that does better,
/// or one to try. At most one of the two is there.
struct Poor {
    std::string reason;
    std::string better = {};  ///< was tried, and is not poor; of fits, see judgeFit
    std::string toTry = {};   ///< was not tried

    /// "poor: REASON; better: CALL", "…; to try: CALL", or that no form is known.
    std::string line() const;
};
/// {"reason": …, "better": …}, and "to_try" where there is one.
nlohmann::ordered_json poorJson(const Poor& poor);

/// The share of its source's energy that a result captures: 1 - relative L2^2 of the quantity that
/// was projected, in the norm of the basis at the outgoing directions of the result, also where
/// coefficients were changed or something was taken out. Forms in which both directions are
/// expanded have it at the directions over which `compare` compares. Where that energy does not
/// exist it is the share of f cos(theta_i); the halfway form has that of f cos(theta_i)
/// cos(theta_o), over `pairs`, which are computed if none are given. None where the source is 0 or
/// not finite, and for least squares, which have a residual instead.
std::optional<double> capturedShare(const Projection& projection, const Brdf& source);
std::optional<double> capturedShare(const Representation& kept, const Brdf& source,
                                    const std::optional<PairSummary>& pairs = {});

/// The share that coefficients from a file capture, without their source: none for least squares,
/// and where the file has no energy.
std::optional<double> capturedShare(const Coefficients& coefficients);
/// The reason why the coefficients of an opened file are poor, by the energy that they capture of
/// their source; empty where they are not, and for other BRDFs.
std::string poorContents(const Brdf& opened);
/// The share of the light that a sphere under even light sends to a distant viewer for which there
/// are no samples and f is 0, in a sentence; empty where it is less than a twentieth.
std::string unmeasuredContents(const Brdf& opened);

/// The function of whose energy capturedShare is a share: "f", "f cos(theta_i)" or
/// "f cos(theta_i) cos(theta_o)".
std::string_view capturedFunction(const Projection& projection);
std::string_view capturedFunction(const Representation& kept);

/// Plain coefficients, with the advice of better_form.h.
std::optional<Poor> judge(const Projection& projection, std::optional<double> captured,
                          const std::optional<PictureError>& picture, const Brdf& source,
                          const std::string& output);
/// The call that captures more than coefficients with this head: the order up to 24 that captures
/// enough at a few outgoing directions; else the halfway form, which is not tried, if f^2 is about
/// the mirror direction; else empty. Of scattered data with fewer measured pairs than such a form
/// has functions it is the fit of a model.
std::string betterCall(const CoefficientHead& head, const Brdf& source, const std::string& output);
/// The least order, up to 24, that captures enough of a BRDF at a few outgoing directions; none
/// where there is none. `head` says the basis, the quantity and the outgoing directions.
std::optional<int> sufficientOrder(const Brdf& source, const CoefficientHead& head);
/// Whether most of the energy of f cos cos has its half vector within 20 degrees of the normal: the
/// halfway form resolves lobes there, and no others.
bool isAboutTheMirror(const Brdf& source);
/// A form. Where a step changed it much, that is named, and the form without it is tried first.
std::optional<Poor> judge(const Representation& kept, std::optional<double> captured,
                          const std::optional<PictureError>& picture, const Brdf& source,
                          const std::string& output);
/// An export of the coefficients of `source` at `path` to `folder`, with its largest cause of
/// error. The remedy of that cause is tried first.
std::optional<Poor> judge(const gpu::ErrorSplit& split, const std::optional<PictureError>& picture,
                          const gpu::Payload& payload, const Brdf& source, const std::string& path,
                          const std::string& folder);
/// A fit that was made in a trial.
struct TriedFit {
    std::string model;
    std::string loss = {};              ///< if not the loss of the poor fit; empty: the same
    double explained = 0;               ///< share of the data, in units of its loss
    std::optional<double> flip = {};    ///< mean FLIP, where pictures can be drawn
    std::optional<double> factor = {};  ///< the median of brdfs::SampleFactors, of measured samples
};
/// The making of a fit, for the call that does better.
struct FitCall {
    std::string data, model;
    double explained = 0;                ///< share of the data, in units of the loss
    double relativeError = 0;            ///< of f cos(theta_i)
    double factor = 1;                   ///< the median of brdfs::SampleFactors
    std::string_view loss = {};          ///< that was minimised
    std::vector<Setting> settings = {};  ///< those that a call with another model shares
    std::string otherwise = {};  ///< advice where no model is better; empty: the halfway form
};
/// The advice for data that no model describes well: empty where they determine the halfway form,
/// else that there are too few measured pairs of directions.
std::string adviceBeyondModels(const Brdf& data);
/// A fit, which captures 1 - relativeError^2 of the energy. Where its pictures are poor, better is
/// the fit of `tried` with the least FLIP, if that is lower by a tenth; where half of the measured
/// samples are off by a factor of more than 2, likewise that with the least such factor. Else it is
/// the loss of f cos(theta_i) if the error of that exceeds f itself, in peaks that the fit's own
/// loss hardly sees, or the model of `tried` that explains most of the data, if that is 2 % more.
/// Where none is better, `otherwise` or the halfway form is to try. `tried` is called for poor fits
/// only.
std::optional<Poor> judgeFit(const std::optional<PictureError>& picture, const FitCall& call,
                             const std::function<std::vector<TriedFit>()>& tried);

}  // namespace hshfit::jobs
