#pragma once

#include <hshfit/representation/halfway/halfway_axes.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/halfway/internal/halfway_gram.h>
#include <hshfit/representation/halfway/internal/halfway_samples.h>

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace hshfit::inline representation::inline halfway {

struct HalfwayAlbedo;
class HalfwayAlbedoErrors;

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

/// One channel at given coefficients: the gradient of the loss and Gauss and Newton's matrix.
struct HalfwaySystem {
    Eigen::MatrixXd gram;
    Eigen::VectorXd slope;
};

/// The samples, and the way in which errors count: as squares up to `huber`, beyond it as
/// themselves.
struct HalfwayData {
    const HalfwaySamples& samples;
    const HalfwayAlbedo* albedo;  ///< none: only pairs
    double huber;
};

/// The terms at pairs of directions, which no coefficient changes. The terms of the first pairs are
/// `held`, as many as take little memory; the others are computed when they are asked for.
class HalfwayProducts {
public:
    HalfwayProducts(const HalfwayModel& model, const std::vector<DirectionPair>& pairs, bool held);

    /// The terms of one pair as a column, with zeros after the last, and the weight of the lobe.
    struct Columns {
        std::vector<double> space = {}, weightSpace = {};
        const double *terms = nullptr, *weights = nullptr;
    };
    /// The columns of `count` pairs from `first` on, for as long as `columns` and this exist.
    void find(std::size_t first, std::size_t count, Columns& columns) const;
    std::size_t rows() const { return rows_; }

private:
    void compute(std::size_t first, std::size_t count, double* terms, double* weights) const;

    const HalfwayModel& model_;
    const std::vector<DirectionPair>& pairs_;
    std::size_t rows_;
    std::vector<double> terms_ = {}, weights_ = {};
};

/// The errors of a form at data, step by step. The same for any number of threads.
class HalfwayErrors {
public:
    HalfwayErrors(const HalfwayModel& model, const HalfwayData& data);
    void countSquaresUpTo(double huber) { data_.huber = huber; }
    ~HalfwayErrors();
    HalfwayErrors(const HalfwayErrors&) = delete;
    HalfwayErrors& operator=(const HalfwayErrors&) = delete;

    /// The loss of each channel at coefficients.
    std::vector<double> losses(const HalfwayValues& values);
    /// The systems at the coefficients that `losses` had last, of the channels that are wanted.
    std::vector<HalfwaySystem> systems(const std::vector<bool>& wanted) const;

private:
    void addLosses(std::size_t first, std::size_t last, const HalfwayValues& values,
                   std::vector<double>& losses);
    void addSamples(std::size_t first, std::size_t last, const std::vector<bool>& wanted,
                    std::vector<HalfwaySystem>& systems) const;

    const HalfwayModel model_;
    HalfwayData data_;
    HalfwayProducts products_;
    std::vector<HalfwayResidual> residuals_;  ///< [sample][channel]
    std::unique_ptr<const HalfwayAlbedoErrors> albedo_;
    double share_;
};

/// The mean over samples, by their weights, and channels, of Huber's function of
/// ln(g + e) - ln(f + e).
double halfwayLoss(const HalfwayModel& model, const HalfwaySamples& samples, double huber,
                   const HalfwayValues& values);

/// Coefficients to begin with: constants.
HalfwayValues halfwayStart(const HalfwayModel& model, const HalfwaySamples& samples);

/// At most `steps` steps of Levenberg and Marquardt's method; `stepDone` is called after each.
HalfwayValues descended(HalfwayErrors& errors, HalfwayValues values, int steps,
                        const std::function<void()>& stepDone = {});

/// The greatest exponents over the samples where their part counts, and the greatest f of the BRDF:
/// for each channel, in single precision.
std::vector<HalfwayCeiling> halfwayCeilings(const HalfwayModel& model,
                                            const HalfwaySamples& samples,
                                            const HalfwayValues& values);

/// f at pairs, [pair][channel], without ceilings.
std::vector<double> halfwayAt(const HalfwayModel& model, const std::vector<DirectionPair>& pairs,
                              const HalfwayValues& values);

}  // namespace hshfit::inline representation::inline halfway
