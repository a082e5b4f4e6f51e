#pragma once

#include <hshfit/representation/halfway/halfway_axes.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/halfway/internal/halfway_samples.h>

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace hshfit::inline representation::inline halfway {

struct HalfwayAlbedo;

/// exp of more than that is cut off: a step of the descent may go astray.
inline constexpr double greatestExponent = 60;

/// Coefficients [term][channel].
using HalfwayValues = Eigen::MatrixXd;

/// The parts that do not change while a form is fitted.
struct HalfwayModel {
    const HalfwayTerms& terms;
    const HalfwayAxes& axes;
    double floor;  ///< e of ln(f + e)
};

/// One channel at given coefficients: the loss, its gradient and Gauss and Newton's matrix.
struct HalfwaySystem {
    Eigen::MatrixXd gram;
    Eigen::VectorXd slope;
    double loss = 0;
};

/// The samples, and the way in which errors count: as squares up to `huber`, beyond it as
/// themselves.
struct HalfwayData {
    const HalfwaySamples& samples;
    const HalfwayAlbedo* albedo;  ///< none: only pairs
    double huber;
};

/// The part of a channel's system that is computed; matrix and gradient take most of the time.
enum class HalfwayNeed : unsigned char { nothing, loss, all };

/// The systems of all channels, what is not needed left empty; the same for any number of threads.
std::vector<HalfwaySystem> halfwaySystems(const HalfwayModel& model, const HalfwayData& data,
                                          const HalfwayValues& values,
                                          const std::vector<HalfwayNeed>& needs);

/// The mean over samples, by their weights, and channels, of Huber's function of
/// ln(g + e) - ln(f + e).
double halfwayLoss(const HalfwayModel& model, const HalfwaySamples& samples, double huber,
                   const HalfwayValues& values);

/// Coefficients to begin with: constants.
HalfwayValues halfwayStart(const HalfwayModel& model, const HalfwaySamples& samples);

/// At most `steps` steps of Levenberg and Marquardt's method; `stepDone` is called after each.
HalfwayValues descended(const HalfwayModel& model, const HalfwayData& data, HalfwayValues values,
                        int steps, const std::function<void()>& stepDone = {});

/// The greatest exponents over the samples where their part counts, and the greatest f of the BRDF:
/// for each channel, in single precision.
std::vector<HalfwayCeiling> halfwayCeilings(const HalfwayModel& model,
                                            const HalfwaySamples& samples,
                                            const HalfwayValues& values);

/// f at pairs, [pair][channel], without ceilings.
std::vector<double> halfwayAt(const HalfwayModel& model, const std::vector<DirectionPair>& pairs,
                              const HalfwayValues& values);

}  // namespace hshfit::inline representation::inline halfway
