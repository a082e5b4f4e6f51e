#pragma once

#include <brdfs/fit/sample_sigma.h>
#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The weight of a sample in a fit: that of the kind of data, 1, or its solid angle.
enum class SampleWeights { automatic, equal, solidAngle };
/// "auto", "equal" or "solid-angle". Throws UsageError.
SampleWeights findSampleWeights(std::string_view name);

/// cells     of a table
/// measured  scattered measurements, as they are
/// nodes     f at chosen directions: for functions, and for tables in coordinates of their own
enum class SampleOrigin { cells, measured, nodes };

/// "cells", "measured" or "nodes".
std::string_view nameOf(SampleOrigin origin);

struct SampleOptions {
    /// automatic: solid angles for tables and functions, equal for scattered samples, which stand
    /// for no area.
    SampleWeights weights = SampleWeights::automatic;
    double grazingCut = 90;     ///< degrees: samples with a larger polar angle are left out
    std::size_t most = 0;       ///< draw so many of the samples; 0: all
    std::uint64_t seed = 1;     ///< of that draw
    SigmaStatement sigma = {};  ///< standard uncertainty of the samples; weights are then 1/sigma^2
    ScanStatement scans = {};   ///< samples whose errors may be correlated
};

/// Numbers of samples left out (a cell of a table, a measured pair).
struct Masked {
    std::size_t belowHorizon = 0;
    std::size_t invalid = 0;    ///< marked as such, or not covered, in some channel
    std::size_t notFinite = 0;  ///< NaN or infinite in some channel
    std::size_t grazing = 0;    ///< beyond `grazingCut`
    std::size_t notDrawn = 0;   ///< above `most`
};

/// Pairs of directions with the values of f that a fit is to follow.
struct FitSamples {
    std::vector<double> wiX, wiY, wiZ;
    std::vector<Direction> wo;
    std::vector<double> values;   ///< [channel * size() + sample], 1/sr
    std::vector<double> weights;  ///< mean 1
    /// Standard uncertainties, [channel * size() + sample], 1/sr; empty: not stated.
    std::vector<double> sigmas;
    /// Number of the scan of each sample, from 0 on; empty: each sample is its own.
    std::vector<std::size_t> scans;
    /// Line (or number) in the file of each measured value, [channel * size() + sample]; empty for
    /// tables and functions.
    std::vector<std::size_t> rows;
    Channels channels;
    bool isotropic = false;
    bool solidAngles = false;  ///< what the weights are
    SampleOrigin origin = SampleOrigin::nodes;
    Masked masked;

    std::size_t size() const { return wo.size(); }
    double value(std::size_t channel, std::size_t k) const { return values[channel * size() + k]; }
    /// Of a value in the loss: that of its sample, over the square of its uncertainty if stated.
    double weight(std::size_t channel, std::size_t k) const {
        if (sigmas.empty()) return weights[k];
        const double sigma = sigmas[channel * size() + k];
        return weights[k] / (sigma * sigma);
    }
    /// Those at `indices`, weights again of mean 1.
    FitSamples subset(const std::vector<std::size_t>& indices) const;
    /// `count` of them, one from each of as many equal runs, at places that `seed` draws.
    FitSamples drawn(std::size_t count, std::uint64_t seed) const;
    /// One channel of them.
    FitSamples channel(std::size_t c) const;
};

/// The samples that stand behind a BRDF: the cells of a MERL table or of slices, scattered
/// measurements as they are (values below zero included); also where that BRDF is seen as RGB or
/// as grey (ChannelView), by the converted values. For anything else f is sampled at nodes
/// in half and difference angles: theta_h (i / 45)^2 90, theta_d 3 j, phi_d 12 k degrees, each at
/// the middle of its bin, and for anisotropic f twelve azimuths of the half vector.
/// Weights by solid angle are those of d(wi) d(wo) = 4 cos(theta_d) d(h) d(d).
/// Throws NumericError if none is left; for the statements as sample_sigma.h says.
FitSamples gatherSamples(const Brdf& data, const SampleOptions& options);

}  // namespace hshfit::brdfs
