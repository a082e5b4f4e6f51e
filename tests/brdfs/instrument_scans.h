#pragma once

// Synthetic scans of a goniometer with apertures, a dark signal, a scale for each scan and noise
// that runs along it; their truth is known.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/instrument/patch_sums.h>
#include <brdfs/random_draws.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace hshfit::test {

/// The truth, and what its instrument does.
struct ScanTruth {
    std::string spec = "lambert:kd=.4 + ggx:ks=.3,F0=.9,alpha=.1";
    std::string model = "lambert + ggx:F0=.9";
    double alpha = 0.1, kd = 0.4, ks = 0.3;
    std::string source = "cone:1.5", detector = "cone:3";
    double dark = 0.004;       ///< over cos(theta_o), 1/sr
    double scaleWidth = 0.02;  ///< of the scales of scans
    double noise = 0.01;       ///< independent, of f; stated
    double along = 0.01;       ///< along a scan, of f, 0.8 between neighbours; not stated
};

constexpr std::size_t samplesOfAScan = 8;

/// In the plane of incidence through the lobe, up to 80 degrees; exact readings but for the dark
/// signal. Averages are by quadratures far finer than a fit's.
inline brdfs::FitSamples exactScans(const ScanTruth& truth, std::size_t scans, std::uint64_t seed) {
    constexpr double around[samplesOfAScan] = {-45, -20, -8, -3, 1, 5, 12, 30};
    std::mt19937_64 random(seed);
    brdfs::FitSamples samples;
    samples.isotropic = true;
    samples.origin = brdfs::SampleOrigin::measured;
    for (std::size_t s = 0; s < scans; ++s) {
        const double incidence = radians(5 + 50 * uniform(random));
        const Direction wi = directionFromAngles(incidence, 0);
        for (const double away : around) {
            const double theta = incidence + radians(away + 2 * uniform(random));
            samples.wiX.push_back(wi.x);
            samples.wiY.push_back(wi.y);
            samples.wiZ.push_back(wi.z);
            samples.wo.push_back(directionFromAngles(std::min(theta, radians(80)), pi));
            samples.scans.push_back(s);
            samples.weights.push_back(1);
        }
    }
    const brdfs::Instrument instrument =
        brdfs::parseInstrument({.source = truth.source, .detector = truth.detector});
    constexpr std::size_t fine = 6;
    std::vector<brdfs::PatchLevels> levels(samples.size(), {fine, fine});
    samples.values.assign(samples.size(), 0);
    // In parts, because of the number of nodes.
    constexpr std::size_t atOnce = 200;
    const auto brdf = brdfs::open(truth.spec);
    for (std::size_t first = 0; first < samples.size(); first += atOnce) {
        std::vector<std::size_t> some;
        for (std::size_t k = first; k < std::min(samples.size(), first + atOnce); ++k)
            some.push_back(k);
        const std::vector<brdfs::PatchLevels> own(some.size(), {fine, fine});
        const std::vector<double> values =
            brdfs::valuesOf(*brdf, averaged(samples.subset(some), instrument, own));
        for (std::size_t i = 0; i < some.size(); ++i) samples.values[some[i]] = values[i];
    }
    return samples;
}

/// Readings with the dark signal, scales and noise.
inline brdfs::FitSamples noisyScans(const brdfs::FitSamples& exact, const ScanTruth& truth,
                                    std::mt19937_64& random) {
    brdfs::FitSamples samples = exact;
    double scale = 1, along = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (k % samplesOfAScan == 0) {
            scale = 1 + truth.scaleWidth * normal(random);
            along = normal(random);
        }
        const double f = exact.values[k];
        samples.sigmas.push_back(truth.noise * f);
        samples.values[k] = scale * f + truth.dark / samples.wo[k].z +
                            f * (truth.along * along + truth.noise * normal(random));
        along = 0.8 * along + 0.6 * normal(random);
    }
    return samples;
}

/// A fit with the instrument's terms, or without any.
inline brdfs::FitOptions scanFit(const ScanTruth& truth, bool instrument) {
    brdfs::FitOptions options{.model = truth.model, .loss = brdfs::Loss::Kind::l2, .starts = 1};
    options.uncertainty.report = true;
    if (instrument)
        options.instrument = brdfs::parseInstrument({.source = truth.source,
                                                     .detector = truth.detector,
                                                     .dark = "fit",
                                                     .scale = std::to_string(truth.scaleWidth)});
    return options;
}

/// The share of intervals of one and of 1.96 (or `two`) standard errors that hold the truth, and
/// the mean deviation.
struct Coverage {
    std::size_t within = 0, within2 = 0, count = 0;
    double sum = 0, squares = 0, errors = 0;

    /// `two`: 97.5 % of a normal distribution.
    void add(double deviation, double error, double two = 1.959963984540054) {
        ++count;
        within += std::abs(deviation) < error;
        within2 += std::abs(deviation) < two * error;
        sum += deviation;
        squares += deviation * deviation;
        errors += error;
    }
    double one() const { return static_cast<double>(within) / static_cast<double>(count); }
    double two() const { return static_cast<double>(within2) / static_cast<double>(count); }
    double bias() const { return sum / static_cast<double>(count); }
    double deviation() const {
        return std::sqrt(squares / static_cast<double>(count) - bias() * bias());
    }
    double error() const { return errors / static_cast<double>(count); }
};

}  // namespace hshfit::test
