#pragma once

// Synthetic campaigns of a goniometer whose errors are those that a fit is told of: the truth is
// known, so that the share of stated intervals that hold it can be counted.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/instrument/turned.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/instrument_scans.h>
#include <brdfs/random_draws.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace hshfit::test {

inline const std::string campaignTruth = "lambert:kd=.3 + ggx:ks=.25,F0=.9,alpha=.15";

/// Values of the truth by the names of parameters; 0 for parameters of the instrument.
inline double truthOf(const std::string& parameter) {
    if (parameter == "ggx.alpha") return 0.15;
    if (parameter == "lambert.kd") return 0.3;
    return parameter == "ggx.ks" ? 0.25 : 0;
}

/// Exact readings in the plane of incidence, every 5 degrees; sigma is 1 % of f.
inline brdfs::FitSamples exactSweeps(const std::vector<double>& incidences,
                                     const std::vector<double>& wavelengths = {},
                                     const std::string& truth = campaignTruth) {
    brdfs::FitSamples samples;
    samples.isotropic = true;
    samples.origin = brdfs::SampleOrigin::measured;
    for (std::size_t s = 0; s < incidences.size(); ++s)
        for (int theta = -70; theta <= 70; theta += 5) {
            const Direction wi = directionFromAngles(radians(incidences[s]), 0);
            samples.wiX.push_back(wi.x);
            samples.wiY.push_back(wi.y);
            samples.wiZ.push_back(wi.z);
            samples.wo.push_back(directionFromAngles(radians(std::abs(theta)), theta > 0 ? pi : 0));
            samples.weights.push_back(1);
            samples.scans.push_back(s);
        }
    if (!wavelengths.empty()) {
        samples.channels.kind = Channels::Kind::spectral;
        samples.channels.wavelengths = wavelengths;
    }
    samples.values = brdfs::valuesOf(*brdfs::open(truth), samples);
    for (const double f : samples.values) samples.sigmas.push_back(0.01 * f);
    return samples;
}

struct Campaign {
    std::string name;
    brdfs::FitSamples exact;
    brdfs::FitOptions options = {};
    /// Adds errors to exact readings, before their noise.
    std::function<void(brdfs::FitSamples&, std::mt19937_64&)> err = {};

    /// Noise has the correlation that `exact` states: exponential, so that along a scan and over
    /// the wavelengths each value follows from the one before.
    brdfs::FitSamples measured(std::uint64_t seed) const {
        std::mt19937_64 random(seed);
        brdfs::FitSamples samples = exact;
        if (err) err(samples, random);
        const std::size_t channels = samples.channels.count();
        std::vector<double> noise(channels, 0);
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double from = alongScan(k), fresh = std::sqrt(1 - from * from);
            double last = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                const double before = overWavelengths(c);
                last = before * last + std::sqrt(1 - before * before) * normal(random);
                noise[c] = from * noise[c] + fresh * last;
                samples.values[c * samples.size() + k] +=
                    samples.sigmas[c * samples.size() + k] * noise[c];
            }
        }
        return samples;
    }

private:
    double alongScan(std::size_t k) const {
        const double length = exact.correlation.angle;
        if (!(length > 0) || k == 0 || exact.scans[k] != exact.scans[k - 1]) return 0;
        return std::exp(-std::acos(std::min(1.0, dot(exact.wo[k], exact.wo[k - 1]))) / length);
    }
    double overWavelengths(std::size_t c) const {
        const double length = exact.correlation.wavelength;
        if (!(length > 0) || c == 0) return 0;
        const std::vector<double>& nanometres = exact.channels.wavelengths;
        return std::exp(-(nanometres[c] - nanometres[c - 1]) / length);
    }
};

/// The factor of a parameter's standard error for intervals with this probability: Student's where
/// the error is by scan, with its degrees of freedom.
inline double coverageFactor(const brdfs::FitResult& result, std::size_t parameter,
                             double probability) {
    const auto& degrees = result.uncertainty->parameters[parameter].scanDegrees;
    return brdfs::Prediction::pointwise(
        probability, degrees ? *degrees : std::numeric_limits<double>::infinity());
}

/// The share of fits whose intervals hold the truth of a parameter.
inline Coverage coverageOf(const std::vector<brdfs::FitResult>& results, std::size_t parameter) {
    Coverage own;
    for (const brdfs::FitResult& result : results) {
        const double one = coverageFactor(result, parameter, 0.6827),
                     two = coverageFactor(result, parameter, 0.9545);
        const brdfs::FittedParameter& p = result.parameters[parameter];
        own.add(p.value - truthOf(p.name), one * *p.standardError, two / one);
    }
    return own;
}

/// Turns directions by zeros in degrees, one for each sample, of a detector that divides by
/// cos(theta_o).
inline void turnSamples(brdfs::FitSamples& samples, const std::vector<brdfs::AngleZeros>& zeros) {
    const brdfs::FitSamples moved = brdfs::turned(samples, zeros);
    samples.values = brdfs::valuesOf(*brdfs::open(campaignTruth), moved);
    for (std::size_t v = 0; v < samples.values.size(); ++v)
        samples.values[v] *= moved.wo[v % samples.size()].z / samples.wo[v % samples.size()].z;
}

inline std::vector<Campaign> campaigns() {
    const std::vector<double> many{8, 15, 22, 29, 36, 43, 50, 57};
    brdfs::FitOptions plain{
        .model = "lambert + ggx:F0=.9", .loss = brdfs::Loss::Kind::l2, .starts = 1};
    plain.uncertainty.report = true;
    std::vector<Campaign> all;

    all.push_back({"three scans with priors", exactSweeps({15, 35, 50}), plain});
    all.back().options.instrument = brdfs::parseInstrument({.scale = "2%"});
    all.back().err = [](brdfs::FitSamples& samples, std::mt19937_64& random) {
        double scale = 1;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (k == 0 || samples.scans[k] != samples.scans[k - 1])
                scale = std::exp(0.02 * normal(random) - 0.0002);
            samples.values[k] *= scale;
        }
    };

    all.push_back({"common calibration", exactSweeps(many), plain});
    all.back().exact.scans.clear();
    all.back().options.contributions = {brdfs::parseCalibration("0.8%")};
    all.back().err = [](brdfs::FitSamples& samples, std::mt19937_64& random) {
        const double scale = 1 + 0.008 * normal(random);
        for (double& value : samples.values) value *= scale;
    };

    all.push_back({"correlated wavelengths", exactSweeps(many, {450, 500, 550, 600}), plain});
    all.back().exact.correlation.wavelength = 100;

    all.push_back({"correlated angles", exactSweeps(many), plain});
    all.back().exact.correlation.angle = radians(8.0);

    for (const bool scan : {false, true}) {
        const std::string width = scan ? "0.1:scan" : "0.1";
        all.push_back(
            {scan ? "zeros of each scan" : "zeros of the campaign", exactSweeps(many), plain});
        all.back().options.instrument =
            brdfs::parseInstrument({.incidenceZero = width, .detectorZero = width});
        if (!scan) all.back().exact.scans.clear();
        all.back().err = [scan](brdfs::FitSamples& samples, std::mt19937_64& random) {
            std::vector<brdfs::AngleZeros> zeros(samples.size());
            for (std::size_t k = 0; k < samples.size(); ++k) {
                const bool first = k == 0 || (scan && samples.scans[k] != samples.scans[k - 1]);
                if (!first) {
                    zeros[k] = zeros[k - 1];
                    continue;
                }
                zeros[k].incidence = radians(0.1) * normal(random);
                zeros[k].detector = radians(0.1) * normal(random);
            }
            turnSamples(samples, zeros);
        };
    }
    return all;
}

}  // namespace hshfit::test
