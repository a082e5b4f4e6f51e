#pragma once

#include <brdfs/fit/contributions.h>
#include <brdfs/fit/instrument/instrument.h>
#include <brdfs/fit/loss.h>
#include <brdfs/fit/uncertainty.h>

#include <hshfit/time_limit.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The options of a fit (fit.h).
struct FitOptions {
    std::string model;  ///< "MODEL[:key=value,…][+MODEL…]"
    Loss::Kind loss = Loss::Kind::cosine;
    Robust robust = Robust::none;
    /// Residual, in units of g, at which the kernel sets in. 0: that which keeps 95 % efficiency
    /// for Gaussian noise of the spread of the residuals without the kernel (Holland & Welsch 1977,
    /// 10.1080/03610927708827533): 1.345 (Huber) or 2.385 (Cauchy) times 1.4826 median |r|.
    double robustScale = 0;
    bool perChannel = false;  ///< shapes of their own for every channel
    /// Laws over the wavelength, "ior=cauchy:2,kd=spline:6" (dispersion_law.h); empty: shapes are
    /// shared, linear parameters free.
    std::string dispersion = {};
    int starts = 16;  ///< local searches
    /// Values of the shapes, in the order of the result, from which the only search starts; empty:
    /// `starts` searches; NaN: the value of each of the `starts`. `fit` throws UsageError for
    /// another number of values, and for values with laws over the wavelength or terms of the
    /// instrument.
    std::vector<double> from = {};
    std::uint64_t seed = 1;  ///< of the starts
    int iterations = 200;    ///< of the last search
    TimeLimit limit = {};    ///< searches end with it where they are, not converged
    /// To compare models: the search from the best start alone, without second derivatives, whose
    /// loss is near the least.
    bool brief = false;
    std::function<void(std::size_t, std::size_t)> progress = {};
    UncertaintyOptions uncertainty = {};
    /// Between f and the samples; with it the loss has to be l2 or cosine, without a robust kernel
    /// or shapes for each channel.
    Instrument instrument = {};
    /// Errors that all samples share: they add to standard errors, correlations and predictions
    /// (propagated_errors.h). None with a robust kernel and of pixels.
    std::vector<Contribution> contributions = {};
};

}  // namespace hshfit::brdfs
