#pragma once

#include <brdfs/fit/budget.h>
#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/fitted_point.h>
#include <brdfs/fit/instrument/fitted_instrument.h>
#include <brdfs/fit/loss.h>
#include <brdfs/fit/uncertainty.h>

#include <cctype>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

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

    /// "ggx.alpha", or with a channel "ggx.kd R".
    std::string label() const { return channel.empty() ? name : name + " " + channel; }
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

/// Opens the fit: `spec` or `spectrum`, the material without the instrument.
std::unique_ptr<Brdf> openFit(const FitResult& result);

/// f of a fitted specification at samples: [channel * size + k].
std::vector<double> valuesOf(const Brdf& brdf, const FitSamples& samples);
/// The loss of values, as FitResult::loss.
double lossOf(const std::vector<double>& values, const FitSamples& samples, Loss::Kind loss);
/// The loss of any BRDF at samples, as FitResult::loss.
double lossOf(const Brdf& brdf, const FitSamples& samples, Loss::Kind loss);

}  // namespace hshfit::brdfs
