#pragma once

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/instrument/instrument_problem.h>
#include <brdfs/fit/scan_spread.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// A matrix and its spread in the form of Equations.
Equations equationsOf(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& spread);

/// The normal equations of an InstrumentProblem at x, of x and of the scales that are free, in
/// units of the weights. Zeros and scales of scans, which act on the samples of one scan each,
/// follow everything else.
class WholeSystem {
public:
    using Matrix = Eigen::MatrixXd;
    using Vector = Eigen::VectorXd;
    using Indices = std::vector<Eigen::Index>;

    WholeSystem(const InstrumentProblem& problem, const std::vector<double>& x);

    Eigen::Index size() const { return hessian_.rows(); }
    Eigen::Index commonCount() const { return static_cast<Eigen::Index>(problem_.commonCount()); }
    const Matrix& hessian() const { return hessian_; }
    const std::vector<std::size_t>& scales() const { return scales_; }  ///< scans with a free one
    const ReadingRows& rows() const { return rows_; }
    /// Places whose value a prior weighs, and with how much.
    struct Prior {
        Eigen::Index place = 0;
        double weight = 0;
    };
    const std::vector<Prior>& priors() const { return priors_; }

    /// work(value, places, slopes, residual), the last two times the root of the weight; residual =
    /// measured - model.
    template <class Work>
    void forEachValue(const Work& work) const {
        for (std::size_t c = 0; c < problem_.channels(); ++c)
            for (std::size_t k = 0; k < samples_.size(); ++k) {
                const std::size_t v = c * samples_.size() + k;
                const auto [places, slopes] = slopesOf(c, k);
                work(v, places, slopes,
                     std::sqrt(rows_.weights[v]) *
                         (samples_.values[v] - modelAt(v, problem_.scanOf(k))));
            }
    }
    double modelAt(std::size_t v, std::size_t scan) const {
        return rows_.scales[scan] * rows_.material[v] + rows_.added[v];
    }

    /// The spread of values with stated correlations (correlated_spread.h), and of priors.
    Matrix correlatedSpread() const;
    /// The sums of each scan of the samples, with its own places eliminated.
    std::vector<ScanSums> scanSums() const;
    /// The matrix of what scans share, with the places of scans eliminated.
    Matrix reduced() const;
    /// The covariance of all places by errors by scan, given the one `among` what scans share: the
    /// places of a scan follow, and add their own for independent samples of this `variance`.
    Matrix followed(const Matrix& among, double variance) const;

private:
    struct Slopes {
        Indices places;
        Vector slopes;
    };
    Slopes slopesOf(std::size_t channel, std::size_t k) const;
    void addPriors();
    /// The part of a scan's places in the matrix of what scans share, and its solution by the
    /// matrix of the scan's places.
    Matrix across(const Indices& own) const;
    Matrix solved(const Indices& own) const;

    const InstrumentProblem& problem_;
    const FitSamples& samples_;
    ReadingRows rows_;
    std::vector<std::size_t> scales_;
    Indices scalePlaces_;           ///< of each scan; -1: none
    std::vector<Indices> ofScans_;  ///< the places of each scan; empty: none has any
    std::vector<Prior> priors_;
    Matrix hessian_;
};

}  // namespace hshfit::brdfs
