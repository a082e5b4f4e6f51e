#pragma once

#include <brdfs/fit/node_sums.h>
#include <brdfs/fit/sample_sigma.h>
#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The weight of a sample in a fit: as the kind of data has it, 1, or its solid angle.
enum class SampleWeights { automatic, equal, solidAngle };
/// "auto", "equal" or "solid-angle". Throws UsageError.
SampleWeights findSampleWeights(std::string_view name);

/// Where f is taken. automatic: scattered measurements as they are, full tables in half and
/// difference angles at their cells, everything else at nodes; cells: of a table; nodes: of a
/// quadrature, by interpolation if need be.
enum class SamplePlaces { automatic, cells, nodes };
/// "auto", "cells" or "nodes". Throws UsageError.
SamplePlaces findSamplePlaces(std::string_view name);

/// cells     of a table
/// measured  scattered measurements, as they are
/// nodes     f at chosen directions: for functions, and for tables in coordinates of their own
/// pixels    radiance of lit spheres (picture_samples.h)
enum class SampleOrigin { cells, measured, nodes, pixels };

/// "cells", "measured", "nodes" or "pixels".
std::string_view nameOf(SampleOrigin origin);

struct SampleOptions {
    /// automatic: solid angles for tables and functions, equal for scattered samples, which stand
    /// for no area.
    SampleWeights weights = SampleWeights::automatic;
    SamplePlaces places = SamplePlaces::automatic;
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

/// Pairs of directions with the values of f that a fit is to follow; or, with `sums`, values that
/// are sums of f over many pairs, each with the normal of its surface in place of wi.
struct FitSamples {
    std::vector<double> wiX, wiY, wiZ;
    std::vector<Direction> wo;
    std::vector<double> values;   ///< [channel * size() + sample], 1/sr
    std::vector<double> weights;  ///< mean 1
    /// Standard uncertainties, [channel * size() + sample], 1/sr; empty: not stated.
    std::vector<double> sigmas;
    SigmaCorrelation correlation = {};  ///< of the errors of values with stated uncertainties
    /// Number of the scan of each sample, from 0 on; empty: each sample is its own.
    std::vector<std::size_t> scans;
    /// Place of each sample among the gathered samples of its scan; empty without scans.
    std::vector<std::size_t> scanPlaces = {};
    /// Line (or number) in the file of each measured value, [channel * size() + sample]; empty for
    /// tables and functions.
    std::vector<std::size_t> rows;
    std::shared_ptr<const NodeSums> sums = {};
    std::vector<std::size_t> sumRows;  ///< with `sums`: the row of each sample, ascending
    /// The samples at fewer places, for the starts of a search; or null.
    std::shared_ptr<const FitSamples> fewer = {};
    Channels channels;
    bool isotropic = false;
    bool solidAngles = false;  ///< what the weights are
    SampleOrigin origin = SampleOrigin::nodes;
    Masked masked;

    std::size_t size() const { return wo.size(); }
    double value(std::size_t channel, std::size_t k) const { return values[channel * size() + k]; }
    /// Weight of a value in the loss: its sample's, over the square of its uncertainty if stated.
    double weight(std::size_t channel, std::size_t k) const {
        if (sigmas.empty()) return weights[k];
        const double sigma = sigmas[channel * size() + k];
        return weights[k] / (sigma * sigma);
    }
    /// The samples at `indices`, with weights of mean 1 again.
    FitSamples subset(const std::vector<std::size_t>& indices) const;
    /// `count` of the samples, one from each of as many equal runs, at places that `seed` draws.
    FitSamples drawn(std::size_t count, std::uint64_t seed) const;
    /// The samples of one channel.
    FitSamples channel(std::size_t c) const;
};

/// Samples without values, to evaluate a fit at: 0 at each pair in every channel, weights of 1.
FitSamples unmeasuredSamples(std::span<const DirectionPair> pairs, const Channels& channels,
                             bool isotropic);

/// Whether a BRDF is made of scattered measurements, also where it is seen as RGB or as grey.
bool areMeasured(const Brdf& data);

/// The samples that stand behind a BRDF: the cells of a MERL table, scattered measurements as they
/// are (values below zero included); also where that BRDF is seen as RGB or as grey (ChannelView),
/// by the converted values. Anything else, slices of a table included, is sampled at the nodes of a
/// quadrature over wi (gridFor with the lobes of f) for the outgoing directions over which BRDFs
/// are compared (comparedOutgoing), so that sums over samples are the integrals of its metrics.
/// Weights by solid angle are d(wi) d(wo), of cells 4 cos(theta_d) d(h) d(d).
/// Throws NumericError if none is left; for the statements as sample_sigma.h says.
FitSamples gatherSamples(const Brdf& data, const SampleOptions& options);

}  // namespace hshfit::brdfs
