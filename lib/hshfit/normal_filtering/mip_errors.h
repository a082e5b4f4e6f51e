#pragma once

#include <hshfit/normal_filtering/filtered_texel.h>
#include <hshfit/normal_filtering/mip_filter.h>

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline normal_filtering {

/// The base level and its reflectance.
struct FilteredSurface {
    std::size_t width = 0, height = 0;
    std::function<SurfaceTexel(std::size_t x, std::size_t y)> texel;
    /// f in 1/sr of a texel in its own frame, by channel; both directions above its horizon.
    std::function<void(const SurfaceTexel&, const Direction& wi, const Direction& wo,
                       std::span<double> out)>
        brdf;
    /// The same without D, see FilteredTexel.
    FilteredTexel::Rest rest;
    int channels = 3;
    FilteredTexel::Shape shape = {};  ///< of the diffuse part; none: Lambert's
};

struct MipErrorOptions {
    /// Base texels of the truth, one in each cell of the footprint; all where it has fewer.
    int samples = 1024;
    int texels = 8;     ///< mip texels, spread over the level
    int outgoing = 16;  ///< from the normal to 88 degrees
    int incoming = 64;  ///< half of them about the mirror direction, half over the hemisphere
    std::uint64_t seed = 1;
    std::vector<int> orders = {};  ///< of harmonics; empty: as in the layout
    bool harmonics = true;         ///< whether forms of harmonics are measured
    bool atMeanNormal = false;     ///< also the forms with M at the mean normal (MipUse::facets)
    /// Whether base texels count by the area that wo sees of them, max(0, n.wo) / n.z, rather than
    /// equally. Forms do not change.
    bool byVisibleArea = false;
};

/// The distance of a form from the average of f cos(theta_i) over base texels, each with its own
/// normal and 0 below its horizon, times cos(theta_o) of the surface.
struct MipError {
    std::string form = {};  ///< "parameters", "harmonics", "ellipse", the latter "… at normal"
    MipUse use = {};
    std::size_t numbers = 0;  ///< of a texel
    double relative = 0;  ///< L2 over both hemispheres and all mip texels, over the truth's norm
    /// Largest difference, over the largest true value of that mip texel, and its place.
    double maximum = 0;
    Direction wi = {}, wo = {};
    double albedo = 1;  ///< hemispherical albedo over the true one
    /// Largest error of a directional albedo, over the true hemispherical albedo of its mip texel.
    double worstAlbedo = 0;
    std::vector<double> texels = {};  ///< the relative error of each, in its own norm
};
struct MipErrors {
    std::vector<MipError> forms;
    /// Relative L2 standard error of the truth, 0 where it has all texels of the footprint.
    double noise = 0;
};

/// Errors of all forms of one level against the same truth; "parameters" are ordinary mips: mean
/// normal renormalised, mean tangent, lobe place, weights and albedos, in `brdf`.
MipErrors measureMipLevel(const FilteredSurface& surface, int level, const MipLevel& filtered,
                          const LobeTable& table, const MipErrorOptions& options = {});

/// Indices, row * width + column, of the texels of a level that are measured.
std::vector<std::size_t> measuredTexels(std::size_t width, std::size_t height,
                                        const MipErrorOptions& options);

/// A mip texel that is measured.
struct MeasuredTexel {
    std::vector<SurfaceTexel> base = {};  ///< of its footprint: all, or a sample
    bool all = true;
    SurfaceTexel mean = {};  ///< averaged parameters
    std::vector<double> numbers = {};
};

/// The texels that one of several processes measures: [first, last), and a function that gives it
/// the records of the others, [texel][number]. All then have the same bits.
struct MipErrorShare {
    std::size_t first = 0, last = ~std::size_t{0};
    std::function<void(std::vector<double>& records)> gather = {};
};

/// The same for texels that the caller gathers. texel(k, random) is called for the texels of the
/// share, in rising order, one at a time. It must not draw random numbers where other processes
/// measure some of the texels. `surface` needs no `texel`, and no size.
MipErrors measureMipTexels(
    const FilteredSurface& surface, const MipLayout& layout, std::size_t count,
    const std::function<MeasuredTexel(std::size_t k, std::mt19937_64& random)>& texel,
    const LobeTable& table, const MipErrorOptions& options = {}, const MipErrorShare& share = {});

/// The form with the fewest numbers whose relative error is at most `tolerance`; where there is
/// none, the one with the least error.
const MipError& cheapestForm(const MipErrors& errors, double tolerance);

/// The least order whose truncation moves the averages of all texels of a level by at most
/// `tolerance`, in L2 over the sphere relative to their norm (Parseval), within the bands that the
/// level has. LobeTable::truncation tells what these bands miss of the unfiltered lobe.
int orderFor(const MipLevel& level, double tolerance);

}  // namespace hshfit::inline normal_filtering
