#pragma once

// Samples of a dielectric with dispersion, and fits to them under laws over the wavelength.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/random_draws.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace hshfit::test {

using brdfs::FitOptions, brdfs::FitResult, brdfs::FitSamples, brdfs::FittedParameter;
using brdfs::Loss, brdfs::SampleOrigin;

inline std::vector<double> range(double first, double last, std::size_t count) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(first +
                         (last - first) * static_cast<double>(i) / static_cast<double>(count - 1));
    return values;
}

inline const std::vector<double> wavelengths = range(400, 800, 9);
constexpr double indexA = 1.46, indexB = 0.012;

/// A dielectric with Cauchy's dispersion over a diffuse base whose albedo rises with the
/// wavelength; directions near the mirror direction and off it.
inline std::string truthAt(double nm) {
    const double n = indexA + indexB / (nm * nm * 1e-6);
    return fmt::format("lambert:kd={} + ggx:fresnel=dielectric,ior={},alpha=0.2",
                       0.2 + 0.3 * (nm - 400) / 400, n);
}

inline FitSamples spectralSamples(std::size_t count, std::uint64_t seed,
                                  const std::function<std::string(double)>& spec = truthAt) {
    std::mt19937_64 random(seed);
    FitSamples samples;
    samples.isotropic = true;
    samples.origin = SampleOrigin::measured;
    for (std::size_t k = 0; k < count; ++k) {
        const Direction wi =
            directionFromAngles(1.35 * std::sqrt(uniform(random)), 2 * pi * uniform(random));
        const bool near = k % 2 == 0;
        const double theta = near ? std::acos(wi.z) + 0.15 * normal(random) : 1.3 * uniform(random);
        samples.wiX.push_back(wi.x);
        samples.wiY.push_back(wi.y);
        samples.wiZ.push_back(wi.z);
        samples.wo.push_back(directionFromAngles(
            std::min(std::abs(theta), 1.4),
            azimuth(wi) + pi + (near ? 0.15 * normal(random) : 2 * pi * uniform(random))));
        samples.weights.push_back(1);
        samples.scans.push_back(k / 5);
    }
    FitSamples grey = samples;
    samples.channels = Channels::spectral(wavelengths);
    for (const double nm : wavelengths)
        for (const double f : brdfs::valuesOf(*brdfs::open(spec(nm)), grey)) {
            samples.sigmas.push_back(0.02 * f + 1e-4);
            samples.values.push_back(f + samples.sigmas.back() * normal(random));
        }
    samples.scans.clear();
    return samples;
}

inline const std::string model = "lambert + ggx:fresnel=dielectric,ks=1";

inline FitOptions optionsOf(const std::string& dispersion) {
    FitOptions options{.model = model, .loss = Loss::Kind::l2, .starts = 2};
    options.dispersion = dispersion;
    options.uncertainty.report = true;
    return options;
}

inline const FittedParameter& parameter(const FitResult& result, const std::string& name,
                                        const std::string& channel = "") {
    for (const FittedParameter& own : result.parameters)
        if (own.name == name && own.channel == channel) return own;
    throw std::out_of_range(name + " " + channel);
}

}  // namespace hshfit::test
