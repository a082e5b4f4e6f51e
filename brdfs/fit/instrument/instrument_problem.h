#pragma once

#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/instrument/instrument.h>
#include <brdfs/fit/instrument/turned.h>
#include <brdfs/fit/instrument/veil.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// Samples as an instrument reads them.
struct Readings {
    FitSamples samples;  ///< averaged over the apertures (patch_sums.h)
    Instrument instrument;
    std::optional<Veil> veil = {};  ///< for stray light
    std::vector<double> mix = {};   ///< slitMatrix
};

/// The problem at a point, value by value; values are v = channel * samples + sample.
struct ReadingRows {
    /// The places in x on which the values of each channel depend.
    std::vector<std::vector<std::size_t>> places;
    std::vector<double> material;  ///< (1 - stray) F + stray V
    std::vector<double> added;     ///< offset and dark signal
    std::vector<std::vector<double>>
        slopes;  ///< [channel][sample * places + i], of a material + added
    /// The zero of an angle on which each sample depends: its place in x, and the slopes of values
    /// by it, per degree.
    struct ByZero {
        std::vector<std::size_t> places;
        std::vector<double> slopes;
    };
    std::vector<ByZero> zeros;   ///< of incidence and of the detector, those that are fitted
    std::vector<double> scales;  ///< of each scan; one of 1 without
    std::vector<double> weights;
};

/// The least-squares problem of a fit with an instrument (Instrument), with the losses l2 and
/// cosine. x: shapes' u, linear[k * channels + c], offset[c], dark[c], stray, zeros of angles in
/// degrees (of all samples, then of incidence for each scan, then of the detector), zeros
/// that are fitted. The scales of scans have their best values for each x.
/// cost = (sum w (model - y)^2 + sum over scans ((ln a + width^2 / 2) / width)^2 + sum (zero /
/// width)^2) / 2 / normalisation: E[ln a] = -width^2 / 2 where a is 1 in the mean, so that 200
/// scans of 2 % do not raise f by 2 %^2, a third of its error.
class InstrumentProblem {
public:
    /// `times`: how often each sample counts (empty: once), and the prior of its scan.
    InstrumentProblem(const Readings& readings, const ParametricSum& sum, Loss::Kind loss,
                      std::vector<double> times = {});

    const Readings& readings() const { return readings_; }
    const ParametricSum& sum() const { return sum_; }
    std::size_t count() const { return count_; }  ///< of x
    /// Size of x without the zeros of scans, which come last.
    std::size_t commonCount() const { return commonCount_; }
    std::size_t channels() const { return samples_.channels.count(); }
    std::size_t shapeCount() const { return sum_.shapes().size(); }
    double normalisation() const { return normalisation_; }
    Bounds bounds() const;
    /// x of a material without anything of the instrument that is fitted.
    std::vector<double> start(std::vector<double> material) const;

    /// The places of the instrument's numbers in x; none: not fitted.
    std::optional<std::size_t> offsetPlace() const { return offset_; }
    std::optional<std::size_t> darkPlace() const { return dark_; }
    std::optional<std::size_t> strayPlace() const { return stray_; }

    /// The zero of an angle: its first place in x, whether each scan has its own, and the width.
    struct Zero {
        std::size_t first = 0;
        bool ofScan = false, detector = false;
        double width = 0;
        std::vector<double> priors = {};  ///< 1 / width^2, times how often its scan counts
    };
    const std::vector<Zero>& zeros() const { return zeros_; }
    /// Zeros of scans that fit the samples best, everything else in x as it is.
    void setZerosOfScans(std::vector<double>& x) const;
    /// The sum of the squares of the priors of zeros.
    double zeroSquares(std::span<const double> x) const;

    ReadingRows rows(std::span<const double> x, bool derivatives) const;
    /// Scales have their best values for x, so that the Gauss-Newton matrix belongs to the problem
    /// without them (variable projection).
    Equations equations(std::span<const double> x, bool derivatives) const;
    /// Expected readings: [channel * samples + k].
    std::vector<double> model(std::span<const double> x) const;

    /// 1/width^2 of the scale of a scan, times how often it counts; 0 without a width.
    double priorOf(std::size_t scan) const { return priors_.empty() ? 0 : priors_[scan]; }
    /// The square of the prior of a scale, and of its slope by the scale.
    double priorSquare(std::size_t scan, double scale) const;
    double priorWeight(std::size_t scan, double scale) const {
        return priorOf(scan) / (scale * scale);
    }
    /// Whether a scan's scale is fitted: all but the first, and that too if scales have a width.
    bool freeScale(std::size_t scan) const {
        return readings_.instrument.scales && (scan > 0 || !priors_.empty());
    }
    std::size_t scanCount() const { return scanCount_; }  ///< 1 without scales
    std::size_t scanOf(std::size_t k) const {
        return readings_.instrument.scales ? samples_.scans[k] : 0;
    }

private:
    void fillBlock(std::span<const double> x, bool derivatives, std::size_t begin, std::size_t size,
                   std::vector<double>& z, const std::vector<double>& difference,
                   const class ColumnBlocks& columns, ReadingRows& rows) const;
    void setScales(ReadingRows& rows) const;
    void placeZeros();
    std::vector<AngleZeros> zerosAt(std::span<const double> x) const;
    std::vector<double> materialAt(std::span<const double> x) const;
    ReadingRows unscaled(std::span<const double> x, bool derivatives) const;
    void addZeroSlopes(std::span<const double> x, ReadingRows& rows) const;
    void addZeroProducts(const ReadingRows& rows, std::size_t channel, std::size_t k,
                         double residual, Eigen::MatrixXd& hessian,
                         Eigen::VectorXd& gradient) const;
    void addZeroPriors(std::span<const double> x, Eigen::MatrixXd& hessian,
                       Eigen::VectorXd& gradient) const;
    double bestScale(std::size_t scan, double square, double product) const;
    double offsetOf(std::span<const double> x, std::size_t c) const;
    double darkOf(std::span<const double> x, std::size_t c) const;
    double strayOf(std::span<const double> x) const;

    const Readings& readings_;
    const FitSamples& samples_;
    const ParametricSum& sum_;
    std::vector<double> weights_;  ///< of values, with the square of the loss' slope
    std::vector<double> priors_;
    std::vector<double> over_;  ///< 1 / cosines of each sample
    std::optional<std::size_t> offset_, dark_, stray_;
    std::vector<Zero> zeros_;
    std::vector<double> times_;
    std::size_t count_ = 0, commonCount_ = 0, scanCount_ = 1;
    double normalisation_ = 1, largest_ = 0;
};

}  // namespace hshfit::brdfs
