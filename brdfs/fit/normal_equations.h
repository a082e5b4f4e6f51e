#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/loss.h>
#include <brdfs/fit/parametric_sum.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::brdfs {

class Whitening;

/// A sum of squares (or of robust kernels of squares) at a point: half its value, the gradient and
/// the Gauss-Newton matrix. gradient^T hessian^-1 gradient <= 2 cost.
struct Equations {
    double cost = 0;
    std::vector<double> gradient;  ///< [n]
    std::vector<double> hessian;   ///< [n * n]
    /// [n * n], only if asked for: sum of squared gradient terms, each as it would be if its
    /// sample had not been fitted.
    std::vector<double> spread;
};

/// The problem linearised at a point, value by value.
struct WeightedRows {
    std::size_t samples = 0, channels = 0;
    /// Shapes, then the linear parameters of the value's channel; of whitened values all of x.
    std::size_t columns = 0;
    bool whitened = false;
    std::vector<double> slopes =
        {};  ///< of root(w) g(f) by x: [(channel * samples + k) * columns + i]
    std::vector<double> residuals = {};  ///< root(w) (g(measured) - g(f)): [channel * samples + k]
    std::vector<double> values = {};     ///< f, likewise

    /// The place in x of column i for a channel.
    std::size_t place(std::size_t i, std::size_t channel, std::size_t shapes) const {
        return i < shapes || whitened ? i : shapes + (i - shapes) * channels + channel;
    }
};

/// The least-squares problem of one fit. Samples are streamed in blocks of a fixed size whose sums
/// are added in order, so that results do not depend on the number of threads; memory does not
/// grow with samples times parameters.
///
/// cost = sum_{k,c} w_kc rho((g(f) - g(measured))^2) / 2, divided by sum_{k,c} w_kc g(measured)^2
/// (by sum w where all is zero), w_kc = FitSamples::weight. With correlated errors
/// (SigmaCorrelation) joint() and weightedRows() are about whitened values (Whitening), held in
/// memory as a whole.
class FitProblem {
public:
    FitProblem(const FitSamples& samples, const ParametricSum& sum, Loss::Kind loss);

    const FitSamples& samples() const { return samples_; }
    const ParametricSum& sum() const { return sum_; }
    Loss::Kind loss() const { return loss_; }
    std::size_t channels() const { return samples_.channels.count(); }
    std::size_t shapeCount() const { return sum_.shapes().size(); }
    std::size_t linearCount() const { return sum_.linears().size() * channels(); }
    double normalisation() const { return normalisation_; }
    const Whitening* whitening() const { return whitening_.get(); }
    /// Whether eliminated() is exact: the loss is linear in f, and errors are independent.
    bool isLinear() const;

    void setRobust(Robust robust, double scale) { robust_ = robust, scale_ = scale; }

    /// By the shapes' u alone, linear parameters at their best within bounds (variable projection:
    /// Golub & Pereyra 1973, 10.1137/0710036; Kaufman's form of the matrix). `linear[k * channels
    /// + c]` receives them. For a loss that is not linear, of the problem linearised about the
    /// measured values: its weights are multiplied by the squared slope of g there. Linear
    /// parameters of functions of each channel come from two linearisations in turn.
    Equations eliminated(std::span<const double> u, bool derivatives,
                         std::vector<double>& linear) const;

    /// By x = shapes' u, then linear[k * channels + c]; any loss and kernel. With the inverse [n *
    /// n] of the matrix at x, 0 for what is held, `spread` too: residuals over 1 - leverage
    /// (MacKinnon & White 1985, 10.1016/0304-4076(85)90158-7: HC3).
    Equations joint(std::span<const double> x, bool derivatives,
                    std::span<const double> inverse = {}) const;

    /// Without a robust kernel.
    WeightedRows weightedRows(std::span<const double> x) const;
    /// root(w) times changes of the values, [channel * samples + k], made independent likewise.
    std::vector<double> weighted(std::vector<double> changes) const;

    /// g(f) - g(measured) at x: [channel * samples + k].
    std::vector<double> residuals(std::span<const double> x) const;
    /// f at x, likewise.
    std::vector<double> values(std::span<const double> x) const;

private:
    /// Columns of all channels, or of each where a term has functions of its own there.
    std::vector<class ColumnBlocks> columnsAt(std::span<const double> u, bool derivatives,
                                              std::span<const double> linear) const;
    Equations eliminatedAbout(std::span<const double> u, bool derivatives,
                              std::vector<double>& linear) const;
    WeightedRows rowsAt(std::span<const double> x) const;
    Equations whitenedJoint(std::span<const double> x, bool derivatives,
                            std::span<const double> inverse) const;

    const FitSamples& samples_;
    const ParametricSum& sum_;
    Loss::Kind loss_;
    Robust robust_ = Robust::none;
    double scale_ = 1;
    double normalisation_ = 1;
    std::shared_ptr<const Whitening> whitening_;
    std::vector<double> mapped_;  ///< data by the loss, in the order of samples().values
    std::vector<std::vector<double>> projectionWeights_;  ///< roots; of all channels or of each
};

/// The minimum of x^T A x / 2 - b^T x for lower <= x <= upper, A positive semidefinite [n * n]:
/// bounded-variable active sets (Stark & Parker 1995). Columns of norm 0 stay at `lower`. Throws
/// NumericError where the sets go round in a circle with more to gain than rounding.
std::vector<double> solveBounded(std::span<const double> a, std::span<const double> b,
                                 std::span<const double> lower, std::span<const double> upper);

}  // namespace hshfit::brdfs
