#pragma once

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/projection/projection.h>
#include <hshfit/representation/representation.h>
#include <hshfit/wording.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A result that misses more than a tenth of the energy of its source: what is wrong with it, and
/// the call that does better.
struct Poor {
    std::string reason;
    std::string better;

    std::string line() const;  ///< "poor: REASON; better: CALL"
};
/// {"reason": …, "better": …}
nlohmann::ordered_json poorJson(const Poor& poor);

/// The least share of the energy that is not poor, and the relative root-mean-square error that
/// leaves as much: error^2 is the energy that is missed.
inline constexpr double leastCaptured = 0.9;
inline constexpr double mostError = 0.31622776601683794;  // sqrt(1 - leastCaptured)

/// The share of its source's energy that a result captures. Plain coefficients and orthonormal ones
/// have it from their squares; other bases, forms in which both directions are expanded and those
/// of an energy that does not exist, from f cos(theta_i) at their few outgoing directions or else
/// from f cos(theta_i) cos(theta_o) over `pairs`, which are measured if none are given. None where
/// the source is 0 or not finite, and for least squares, which have a residual instead.
std::optional<double> capturedShare(const Projection& projection, const Brdf& source);
std::optional<double> capturedShare(const Representation& kept, const Brdf& source,
                                    const std::optional<PairSummary>& pairs = {});

/// Plain coefficients: the share that they capture, or the residual of least squares. The call that
/// does better is found by a trial: the order up to 24 that captures enough at a few outgoing
/// directions; else the halfway form, or a finer one, if f^2 is about the mirror direction; else
/// twice the order.
std::optional<Poor> judge(const Projection& projection, std::optional<double> captured,
                          const Brdf& source, const std::string& output);
/// The call that captures more than coefficients with this head, by the same trial; empty if it
/// finds neither an order nor that the halfway form is made for this BRDF.
std::string betterCall(const CoefficientHead& head, const Brdf& source, const std::string& output);
/// The least order, up to 24, that captures enough of a BRDF at a few outgoing directions; none
/// where there is none. `head` says the basis, the quantity and the outgoing directions.
std::optional<int> sufficientOrder(const Brdf& source, const CoefficientHead& head);
/// Whether most of the energy of f cos cos has its half vector within 20 degrees of the normal: the
/// halfway form resolves lobes there, and no others.
bool isAboutTheMirror(const Brdf& source);
/// A form: the step that changed it most, or the share that it captures.
std::optional<Poor> judge(const Representation& kept, std::optional<double> captured,
                          const std::optional<PairSummary>& pairs, const Brdf& source,
                          const std::string& output);
/// An export of the coefficients at `path` to `folder`: its largest cause of error.
std::optional<Poor> judge(const gpu::ErrorSplit& split, const gpu::Payload& payload,
                          const std::string& path, const std::string& folder);
/// A model that was fitted in a trial, and the share of the data that it explains.
struct TriedModel {
    std::string model;
    double explained = 0;
};
/// A fit that explains the share `explained` of its data, in units of its loss: better is the model
/// of the trial that explains most; the halfway form if none explains 2 % more. `settings`: those
/// that the call shares with the fit.
std::optional<Poor> judgeFit(double explained, const std::string& data,
                             const std::vector<TriedModel>& tried, std::vector<Setting> settings);
/// A fit by another loss than that of f cos(theta_i), of which `relativeError` is the error there:
/// better is that loss where the error exceeds f itself, in peaks that `loss` hardly sees.
std::optional<Poor> judgePeaks(double relativeError, const std::string& data,
                               const std::string& model, std::string_view loss);

}  // namespace hshfit::jobs
