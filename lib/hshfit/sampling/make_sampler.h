#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/disc_table.h>
#include <hshfit/sampling/mixture.h>
#include <hshfit/sampling/proposal.h>

#include <cstddef>
#include <memory>
#include <optional>

namespace hshfit::inline sampling {

/// The parts of a sampler besides the cosine, which always has a share, so that the weight f cos /
/// pdf is at most pi f / leastCosine.
struct SamplerOptions {
    bool known = true;     ///< the BRDF's own densities (HasSamplers)
    bool proposal = true;  ///< a fitted mixture, where the BRDF names no densities that cover it
    bool table = true;     ///< a table, likewise
    std::size_t elevations = 32;  ///< for each of which shares are found
    double leastCosine = 1.0 / 32;
    DiscTableOptions tabulation = {};
    ProposalOptions fit = {};
    /// A proposal that is there already, instead of a fit.
    std::optional<Proposal> fitted = {};
};

/// A sampler of f cos(theta_i), |f| averaged over channels: the shares of its parts minimise the
/// second moment of the weight at the middle of each bin of elevation (three azimuths if f is not
/// isotropic). Built once, with all cores; the result is the same for any number of them. Works
/// for every BRDF: values that are not finite count as 0, `reflects` is false
/// where f is 0, and the samples are the cosine's.
std::unique_ptr<MixtureSampler> makeSampler(const Brdf& brdf, const SamplerOptions& options = {});

}  // namespace hshfit::inline sampling
