#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::brdfs {

class VarianceFreedom;

/// A fit at one channel, as a point about which predictions are linearised (prediction.h).
struct FittedChannel {
    std::string model;           ///< of a ParametricSum
    std::vector<double> values;  ///< of the sum's shapes, then of its linear parameters
    struct Slope {
        std::size_t coefficient = 0;
        double slope = 0;
    };
    /// Derivatives of each value by the coefficients of the fit, those that are not 0.
    std::vector<std::vector<Slope>> slopes;
    std::size_t channel = 0;  ///< of the fit
    bool coloured = false;    ///< of the ParametricSum
};

/// The coefficients of a fit are its parameters, or else the coefficients of laws over wavelength
/// from which the parameters in each channel follow.
struct FittedPoint {
    bool isotropic = true;  ///< as the samples were
    std::vector<FittedChannel> channels;
    /// Covariance of the coefficients, [n * n]: by scan, or else the sandwich. 0 for what a bound
    /// holds; without directions in which no sample changes, so that f at the samples has its
    /// variance also where the data do not tell parameters apart.
    std::vector<double> covariance;
    /// Degrees of freedom of its parts, each of consecutive coefficients; none for more than 20,000
    /// values without scans, where they hardly matter, and for sums of f.
    struct Freedom {
        std::size_t first = 0;
        std::shared_ptr<const VarianceFreedom> of;
    };
    std::vector<Freedom> freedom;
    /// An error common to all samples: the change of the coefficients by one standard uncertainty,
    /// a part of `covariance`, and its degrees of freedom.
    struct Common {
        std::vector<double> change;
        double degrees = 0;
    };
    std::vector<Common> common = {};
    /// Fits to resampled data: [draw][channel] as FittedChannel::values; a draw that did not
    /// converge is empty.
    std::vector<std::vector<std::vector<double>>> draws;
};

}  // namespace hshfit::brdfs
