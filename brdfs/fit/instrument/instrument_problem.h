#pragma once

#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/instrument/instrument.h>
#include <brdfs/fit/instrument/veil.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>

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
    /// Of each channel: the places in x on which its values depend.
    std::vector<std::vector<std::size_t>> places;
    std::vector<double> material;  ///< (1 - stray) F + stray V
    std::vector<double> added;     ///< offset and dark signal
    std::vector<std::vector<double>>
        slopes;                  ///< [channel][sample * places + i], of a material + added
    std::vector<double> scales;  ///< of each scan; one of 1 without
    std::vector<double> weights;
};

/// The least-squares problem of a fit with an instrument (Instrument), with the losses l2 and
/// cosine. x: shapes' u, linear[k * channels + c], offset[c], dark[c], stray, those that are
/// fitted. The scales of scans have their best values for each x.
/// cost = (sum w (model - y)^2 + sum over scans ((ln a + width^2 / 2) / width)^2) / 2 /
/// normalisation: E[ln a] = -width^2 / 2 where a is 1 in the mean, so that 200 scans of 2 % do not
/// raise f by 2 %^2, a third of its error.
class InstrumentProblem {
public:
    /// `times`: how often each sample counts (empty: once), and the prior of its scan.
    InstrumentProblem(const Readings& readings, const ParametricSum& sum, Loss::Kind loss,
                      std::vector<double> times = {});

    const Readings& readings() const { return readings_; }
    const ParametricSum& sum() const { return sum_; }
    std::size_t count() const { return count_; }  ///< of x
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

    ReadingRows rows(std::span<const double> x, bool derivatives) const;
    /// With scales at their best: the Gauss-Newton matrix is that of the projected problem.
    Equations equations(std::span<const double> x, bool derivatives) const;
    /// Expected readings: [channel * samples + k].
    std::vector<double> model(std::span<const double> x) const;

    /// 1/width^2 of the scale of a scan, times how often it counts; 0 without a width.
    double priorOf(std::size_t scan) const { return priors_.empty() ? 0 : priors_[scan]; }
    /// The square of the prior of a scale, and that of its slope by the scale.
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
    std::size_t count_ = 0, scanCount_ = 1;
    double normalisation_ = 1, largest_ = 0;
};

}  // namespace hshfit::brdfs
