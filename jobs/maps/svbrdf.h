#pragma once

#include <jobs/common/listener.h>
#include "pair_checks.h"

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/material_maps/map_writer.h>
#include <hshfit/material_maps/reduction.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct SvbrdfOptions {
    std::string form = "outgoing";  ///< "outgoing", "low-rank", "clusters", "halfway" or "library"
    std::string basis = "hsh";
    int order = 4;
    std::string outgoing;  ///< OutgoingSet::parse; empty: 8 elevations if isotropic, else 8x8
    bool cosine = false;   ///< f cos(theta_i) instead of f
    std::string precision = "float16";  ///< or "float32"; clusters have bytes
    double tolerance = 1e-3;            ///< of the table of lobes, relative
    std::size_t rank = 0;               ///< shared shapes; 0: as many as `error` takes
    double error = 0.01;                ///< the largest error of a sampled texel, relative
    std::size_t clusters = 256;
    HalfwayOrders halfway = {8, 4, 3};  ///< of the shared materials of the form halfway
    std::string library = {};           ///< of the form library; empty: learned from the map
    std::size_t components = 0;  ///< of that library; 0: usualComponents, or all of a given one
    bool mips = true;
    bool force = false;
    std::size_t memory = std::size_t{1} << 30;  ///< bytes for bands, of each process
    bool pastPageCache = true;                  ///< texels go straight to the disk
    std::size_t samples = 32768;                ///< texels that shapes and clusters are made from
    std::size_t checks = 16;                    ///< texels of each level that are measured
    /// After that time nothing more is measured: levels go without checks, and other numbers of
    /// clusters are not tried.
    std::optional<double> seconds = {};
};

/// At most so many of the texels of a level that are measured are also compared with their BRDFs
/// over pairs of directions.
inline constexpr std::size_t mostPairTexels = 16;

/// Components of a library that is learned from a map: with the mean, three texels of four numbers
/// for each channel.
inline constexpr std::size_t usualComponents = 11;

/// A form and its cost and error over sampled texels.
struct MapChoice {
    std::string form = {};
    std::size_t count = 0;  ///< shared shapes, or materials
    double bytesOfTexel = 0;
    std::size_t sharedBytes = 0;
    /// Relative to the texel, in coefficients; none of the form halfway, which has others.
    std::optional<TexelErrors> errors = {};
    /// Against the BRDFs of a few texels; none of measured texels, or without checks.
    std::optional<TexelPairErrors> pairs = {};
};

/// The distance of texels of a level from the mean of up to 1,024 texels that they stand for,
/// relative to its norm, in coefficients (over all incoming and outgoing directions).
struct LevelCheck {
    std::size_t level = 0, texels = 0;
    double stored = 0, storedMaximum = 0;          ///< as written
    double parameters = 0, parametersMaximum = 0;  ///< of averaged parameters
};

/// The distance of coefficients from the measured samples that they were made from, relative to
/// the norm of the samples of a texel.
struct FitErrors {
    std::size_t texels = 0;  ///< on an even grid
    double mean = 0, maximum = 0;
    std::size_t column = 0, row = 0;  ///< of the maximum
};

/// The library of a map of that form.
struct MapLibrary {
    std::string given = {};     ///< empty: learned from the map
    std::size_t materials = 0;  ///< that it was learned from
    /// The picture error of a few texels of level 0: mean FLIP, in the mean, and the worst of them.
    std::size_t pictures = 0;
    double flip = 0, worstFlip = 0;
    TexelPlace worstAt = {};
    std::string poor = {};  ///< why the worst one is poor (poorReason); empty: it is not
};

struct Svbrdf {
    std::string description = {}, model = {}, folder = {};
    std::size_t width = 0, height = 0;
    std::vector<std::string> lobes = {}, axes = {};
    bool isotropic = false;
    std::string outgoing = {};
    std::size_t tableNodes = 0;
    double tableError = 0;
    double captured = 1;  ///< the least share of energy that the basis holds at a node of the grid
    std::string leastCaptured = {};  ///< the BRDF there
    /// Where that is poor: the order that captures enough of it, or else whether the form halfway
    /// is made for it.
    std::optional<int> betterOrder = {};
    bool halfwayIsBetter = false;
    FitErrors fit = {};  ///< of measured texels
    std::string form = {};
    std::size_t count = 0;  ///< shared shapes, or materials
    std::vector<MapChoice> choices = {};
    std::vector<LevelSize> levels = {};
    std::vector<LevelErrors> errors = {};
    std::vector<LevelCheck> checks = {};
    std::vector<TexelPairErrors> levelPairs = {};  ///< by level, of the forms halfway and library
    std::optional<MapLibrary> library = {};        ///< of the form library
    bool timeIsOver = false;  ///< SvbrdfOptions::seconds were: what is missing was not measured
    std::size_t bytes = 0;
    std::size_t processes = 1;
    bool pastPageCache = false;
    double tableSeconds = 0, kernelSeconds = 0, seconds = 0;
    double kernelRate = 0;  ///< texels per second of the bare kernel, on all threads
    double rate = 0;        ///< texels of level 0 per second of writing
    std::vector<std::string> files = {};
};

/// A description of materials by maps as a coefficient texture with mip levels, in FOLDER:
/// material.ktx2, material.json and errors.png, of the form halfway also the coefficient files
/// material_0000.json, … of its materials. All maps are read and checked before anything is
/// written. Results are the same bytes for any number of threads and processes. Throws UsageError,
/// InputError, NumericError and OutputError.
Svbrdf svbrdf(const std::string& description, const std::string& folder,
              const SvbrdfOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
