#pragma once

#include <brdfs/fit/budget.h>
#include <brdfs/fit/contributions.h>
#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/fitted_point.h>
#include <brdfs/fit/instrument/fitted_instrument.h>
#include <brdfs/fit/loss.h>
#include <brdfs/fit/uncertainty.h>

#include <hshfit/time_limit.h>

#include <cctype>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

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

/// A free parameter after a fit.
struct FittedParameter {
    std::string name;     ///< "ggx.alpha"
    std::string channel;  ///< "R"; empty: all channels
    double value = 0;
    std::string bound;  ///< "lower" or "upper" if it came to rest there
    /// None at a bound, and where the data do not determine it.
    std::optional<double> standardError = {};
    bool linear = false;
    bool instrument = false;  ///< of the instrument, not of the material

    /// Whether it is the scale, or the zero of an angle, of one scan, of which there may be
    /// hundreds.
    bool isScanScale() const {
        return instrument && std::isdigit(static_cast<unsigned char>(name.back()));
    }
};

/// The fit at one wavelength: the specification of a grey BRDF.
struct FittedWavelength {
    double nanometres = 0;
    std::string spec;
};

/// A law over the wavelength with its coefficients (LawCurve).
struct FittedLaw {
    std::string parameter;
    std::string law;  ///< "cauchy:2"
    std::vector<double> coefficients;
};

struct FitResult {
    std::string model;  ///< as it was asked for
    std::string spec;   ///< with values filled in: opens the fit; empty for a spectrum
    std::vector<FittedWavelength> spectrum;  ///< of data with wavelengths, in their order
    std::vector<FittedLaw> laws;             ///< only with FitOptions::dispersion or a metal
    std::vector<FittedParameter> parameters;
    /// Correlations of parameters with a standard error, 0 otherwise: [n * n]. Channels that were
    /// fitted apart do not correlate.
    std::vector<double> correlations;
    /// Sets of parameters that the data do not tell apart, by name and channel.
    std::vector<std::vector<std::string>> ambiguous;
    bool converged = false;
    std::string message;  ///< Ceres' own, of the last search (of the worst channel)
    int iterations = 0, evaluations = 0, startCount = 0;
    std::uint64_t seed = 0;
    double robustScale = 0;
    std::size_t samples = 0, values = 0;  ///< values: samples times channels
    double loss = 0;               ///< root of the weighted mean square of g(f) - g(measured)
    double projectedGradient = 0;  ///< largest component that bounds do not stop, per unit of scale
    double aic = 0, bic = 0;
    std::optional<Uncertainty> uncertainty;  ///< only if asked for
    FittedPoint point;                       ///< for predictions (prediction.h)
    std::optional<FittedInstrument> instrument = {};
    std::optional<Budget> budget = {};  ///< only where contributions are stated
};

/// The parameters with the least loss, from several starts.
///
/// Starts are a Halton sequence with a random shift in the box of the FitRanges (catalog.h); the
/// best of four times `starts` are searched from on at most 4096 of the samples, the best three
/// minima on all. Linear parameters are eliminated where the loss is linear in f. Standard errors
/// are those of the sandwich estimator (White 1980, 10.2307/1912934): they hold for weights and
/// noise of any kind, but take the residuals of samples for independent, and the model for true.
/// AIC and BIC are those of Gaussian residuals of g with the given weights.
///
/// Samples with stated uncertainties are weighted by 1/sigma^2 (the loss has to be l2): the loss is
/// the root of the weighted mean square of f - measured, and AIC and BIC are chi-square plus their
/// terms, because the variance is known. With scans, errors and correlations are those by scan.
///
/// With laws over the wavelength, or a metal in the model, it is fitDispersed (dispersion.h).
///
/// Throws UsageError for the model, for stated uncertainties with another loss, and for a study of
/// uncertainties with a robust kernel; NumericError if there are fewer values than parameters.
FitResult fit(const FitSamples& samples, const FitOptions& options);

/// Opens the fit: `spec` or `spectrum`, the material without the instrument.
std::unique_ptr<Brdf> openFit(const FitResult& result);

/// f of a fitted specification at samples: [channel * size + k].
std::vector<double> valuesOf(const Brdf& brdf, const FitSamples& samples);
/// Expected readings of samples by a fit: f, or f as its instrument shows it, with the scales
/// of scans that fit these samples best. [channel * size + k]
std::vector<double> predictedValues(const FitResult& result, const FitSamples& samples);
/// The loss of values, as FitResult::loss.
double lossOf(const std::vector<double>& values, const FitSamples& samples, Loss::Kind loss);
/// The loss of any BRDF at samples, as FitResult::loss.
double lossOf(const Brdf& brdf, const FitSamples& samples, Loss::Kind loss);

}  // namespace hshfit::brdfs
