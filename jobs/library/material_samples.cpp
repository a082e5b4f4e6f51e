#include "material_samples.h"

#include <jobs/common/direction_json.h>
#include <jobs/fits/fit_bands.h>
#include <jobs/source/source.h>
#include "material_library.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/wording.h>

#include <brdfs/fit/fit_samples.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::jobs {
namespace {

namespace ml = material_library;

struct Gathered {
    std::vector<ml::Observation> observations;
    std::size_t all = 0;  ///< samples that there were
};

brdfs::SigmaStatement independentSigma(const std::string& text) {
    brdfs::SigmaStatement sigma = brdfs::parseSigma(text);
    if (sigma.correlation.any())
        throw UsageError(fmt::format(
            "{} '{}': a library takes the errors of samples as independent; leave out the "
            "correlation",
            Setting{"FitOptions::sigma"}, text));
    return sigma;
}

Gathered gather(const Brdf& data, const std::string& spec, const std::string& sigma,
                std::size_t most) {
    if (data.channels().kind == Channels::Kind::spectral)
        throw UsageError(
            fmt::format("{}: is spectral; libraries are grey and RGB, so give rgb:{}", spec, spec));
    brdfs::SampleOptions options{.sigma = independentSigma(sigma)};
    brdfs::FitSamples samples = brdfs::gatherSamples(data, options);
    if (samples.sums)
        throw UsageError(fmt::format("{}: has sums of f over directions, not samples of f", spec));
    Gathered gathered{.observations = {}, .all = samples.size()};
    if (samples.size() > most) samples = samples.drawn(most, options.seed);
    const std::size_t channels = samples.channels.count();
    for (std::size_t k = 0; k < samples.size(); ++k) {
        ml::Observation one{
            .pair = {{samples.wiX[k], samples.wiY[k], samples.wiZ[k]}, samples.wo[k]},
            .values = {},
            .sigmas = {}};
        if (!(one.pair.wi.z > 0 && one.pair.wo.z > 0)) continue;
        for (std::size_t c = 0; c < channels; ++c) {
            one.values.push_back(samples.value(c, k));
            one.sigmas.push_back(samples.sigmas.empty() ? 0
                                                        : samples.sigmas[c * samples.size() + k]);
        }
        gathered.observations.push_back(std::move(one));
    }
    return gathered;
}

std::string angles(const DirectionPair& pair) {
    return fmt::format("{:.10g},{:.10g},{:.10g},{:.10g}", degrees(polarAngle(pair.wi)),
                       degrees(azimuth(pair.wi)), degrees(polarAngle(pair.wo)),
                       degrees(azimuth(pair.wo)));
}

std::string bandRows(const ReconstructedMaterial& done) {
    const bool grey = done.material.channels() == 1;
    std::string text = "theta_i,phi_i,theta_o,phi_o";
    for (const char* name : {"R", "G", "B"}) {
        const std::string of = grey ? "grey" : name;
        text += fmt::format(",{},{}_low,{}_high", of, of, of);
        if (grey) break;
    }
    text += '\n';
    for (std::size_t k = 0; k < done.pairs.size(); ++k) {
        text += angles(done.pairs[k]);
        const ml::Band& band = done.bands[k];
        for (std::size_t c = 0; c < band.value.size(); ++c)
            text += fmt::format(",{:.9g},{:.9g},{:.9g}", band.value[c], band.low[c], band.high[c]);
        text += '\n';
    }
    return text;
}

void requireBoth(const ReconstructOptions& options) {
    if (options.bands.empty() != options.bandsTo.empty())
        throw UsageError(fmt::format("{} and {} belong together", Setting{"FitOptions::bands"},
                                     Setting{"FitOptions::bandsTo"}));
}

}  // namespace

ReconstructedMaterial reconstructMaterial(const std::string& samples, const std::string& output,
                                          const ReconstructOptions& options,
                                          const Listener& listener) {
    requireBoth(options);
    const ml::Library library = ml::readLibrary(options.library);
    ReconstructedMaterial done{.name = materialName(samples)};
    if (!options.bands.empty()) done.pairs = bandPairs(options.bands);
    const auto data = openBrdf(samples);
    const Gathered gathered = gather(*data, samples, options.sigma, options.samples);
    requireReadable(*data);
    if (gathered.all > gathered.observations.size())
        listener.say(
            fmt::format("{} of {} samples are used", gathered.observations.size(), gathered.all));
    const ml::LogSpace space;
    ml::Posterior posterior(space, library);
    done.samples = gathered.observations.size();
    done.agreement = posterior.observe(gathered.observations);
    done.expectedError = posterior.expectedError();
    done.material = posterior.material();
    done.bands = posterior.bands(done.pairs);
    ml::Material material{.name = done.name,
                          .source = samples,
                          .kind = ml::Kind::polynomial,
                          .channels = done.material.channels(),
                          .polynomial = done.material};
    material.bytes = material.polynomial.bytes();
    ml::Library one{.asked = library.asked, .limits = library.limits};
    one.materials = {std::move(material)};
    AtomicFile file(output);
    ml::writeLibrary(one, file);
    if (options.bandsTo.empty()) {
        file.commit();
        return done;
    }
    AtomicFile bands(options.bandsTo);
    bands.write(bandRows(done));
    bands.finish();
    file.commit();
    bands.commit();
    return done;
}

std::vector<ml::NextPair> nextPairs(const std::string& samples, const std::string& output,
                                    const NextPairsOptions& options) {
    const ml::Library library = ml::readLibrary(options.library);
    const brdfs::SigmaStatement sigma = independentSigma(options.sigma);
    using From = brdfs::SigmaStatement::From;
    if (sigma.from != From::nothing && sigma.from != From::formula)
        throw UsageError(
            fmt::format("{} '{}': the next samples have no file yet; give a share or "
                        "a number, such as 2%",
                        Setting{"FitOptions::sigma"}, options.sigma));
    const ml::LogSpace space;
    ml::Posterior posterior(space, library);
    if (!samples.empty()) {
        const auto data = openBrdf(samples);
        posterior.observe(
            gather(*data, samples, options.sigma, ReconstructOptions{}.samples).observations);
        requireReadable(*data);
    }
    const std::vector<ml::NextPair> pairs =
        posterior.next({.count = options.count,
                        .inPlane = options.instrument == "in-plane",
                        .relative = sigma.relative,
                        .absolute = sigma.absolute});
    if (output.empty()) return pairs;
    std::string text = "theta_i,phi_i,theta_o,phi_o,expected_error\n";
    for (const ml::NextPair& next : pairs)
        text += fmt::format("{},{:.6g}\n", angles(next.pair), next.expectedError);
    writeFile(output, text);
    return pairs;
}

}  // namespace hshfit::jobs
