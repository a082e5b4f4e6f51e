#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps {

/// A parameter that varies from texel to texel and on which f depends in any smooth way.
struct LobeAxis {
    std::string name;
    double low = 0, high = 0;  ///< the values that occur
    bool logarithmic = false;  ///< nodes are placed by the logarithm; 0 < low
};

/// Lobes f_k whose weighted sums are the BRDFs of all texels, f = sum of w_k f_k(p): coefficients
/// of each as a function of the parameters p.
struct LobeFunction {
    std::vector<LobeAxis> axes;  ///< at most 3
    std::size_t lobes = 1;
    std::size_t length = 1;  ///< values of a lobe
    /// [lobe][length] at p; called from several threads at once.
    std::function<std::vector<double>(std::span<const double> p)> at = {};
    /// Weights of the squares of `length` values in the norm that errors are measured in.
    std::vector<double> weights = {};
};

struct LobeGridOptions {
    double tolerance = 1e-3;        ///< relative error of interpolation in the norm of the lobes
    std::size_t mostNodes = 20000;  ///< of the table, before NumericError
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Coefficients of lobes at nodes of a grid over the parameters, with cubic interpolation between
/// them (Lagrange, through four nodes of each axis). Intervals are halved until the interpolated
/// lobes agree with computed ones at the middle of every interval, beside every node of the other
/// axes. That test is the stated error; a function that is smooth between these points is assumed.
///
/// Immutable; safe to use from many threads. Results do not depend on their number.
class LobeGrid {
public:
    /// The nodes of a place and their weights: rows of `values()`.
    struct Place {
        std::uint32_t count = 0;
        std::uint32_t row[64];
        float weight[64];
    };

    /// Throws UsageError for more than three axes, and NumericError where the tolerance takes more
    /// than `mostNodes` nodes, with the error that was reached.
    explicit LobeGrid(const LobeFunction& function, const LobeGridOptions& options = {});

    std::size_t axes() const { return nodes_.size(); }
    std::size_t lobes() const { return lobes_; }
    std::size_t length() const { return length_; }
    std::size_t nodes() const { return rows_; }
    std::size_t evaluations() const { return evaluations_; }
    double error() const { return error_; }  ///< relative, the largest that the tests found

    /// [node][lobe][length], each row padded to `rowStride()` floats.
    const std::vector<float>& values() const { return values_; }
    std::size_t rowStride() const { return stride_; }

    /// p[axis]; values outside of the range of an axis are taken as its ends.
    void find(const float* p, Place& place) const;

private:
    struct Axis {
        std::vector<double> places = {};  ///< of nodes, in the variable of interpolation
        bool logarithmic = false;
        /// [first][k] = prod over j of 1 / (x_k - x_j), nodes j and k of the stencil at `first`
        std::vector<double> factors = {};
    };
    struct Stencil {
        std::size_t first = 0, count = 0;
        double weight[4] = {};
    };
    static Stencil stencilOf(const Axis& axis, double place);
    static void findFactors(Axis& axis);
    struct Builder;

    std::vector<Axis> nodes_;
    std::size_t lobes_, length_, stride_ = 0, rows_ = 0, evaluations_ = 0;
    double error_ = 0;
    std::vector<float> values_;
};

}  // namespace hshfit::inline material_maps
