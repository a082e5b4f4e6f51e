#pragma once

#include <jobs/common/listener.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// Forms of textures of materials; the last three have filtered lobes.
inline constexpr std::string_view mapForms[] = {"outgoing", "low-rank", "clusters",  "halfway",
                                                "library",  "ellipse",  "harmonics", "filtered"};
/// Whether a form is one of `filteredMap`, and not of `svbrdf`.
bool isFilteredForm(std::string_view form);

struct FilteredMapOptions {
    /// "ellipse", "harmonics", or "filtered": the one with the fewest numbers within `error`.
    std::string form = "filtered";
    int harmonics = 0;                  ///< order, odd; 0: 9, 17 or 33, by `error`
    double error = 0.1;                 ///< relative, of each level against samples
    std::string precision = "float16";  ///< or "float32"
    bool mips = true;
    bool force = false;
    int checks = 16;  ///< texels of each level that are measured
};

/// The distance of texels of a level from the mean of f cos(theta_i) over up to 1,024 of the texels
/// that they stand for, over both hemispheres.
struct FilteredError {
    double relative = 0;  ///< L2 over all measured texels, over the truth's norm
    double mean = 0;      ///< over texels, each in its own norm
    double maximum = 0;   ///< the worst of them, and its place
    std::size_t column = 0, row = 0;
    double largest = 0;  ///< difference at one pair, over the largest true value; its place
    Direction wi = {}, wo = {};
    double albedo = 1;       ///< hemispherical, over the true one
    double worstAlbedo = 0;  ///< largest error of a directional albedo
};

struct FilteredLevel {
    LevelSize size = {};
    std::size_t texels = 0;  ///< measured
    double noise = 0;        ///< of the truth: relative standard error
    FilteredError stored = {}, parameters = {};
};

/// A form, its cost, and the relative error of its worst level.
struct FilteredChoice {
    std::string form = {};
    int order = 0;
    std::size_t numbers = 0;
    double bytesOfTexel = 0;
    double error = 0;
    std::size_t level = 0;
    double maximum = 0;  ///< of the worst texel of any level, in its own norm, and its place
    std::size_t maximumLevel = 0, column = 0, row = 0;
};

struct FilteredMapAnswer {
    std::string description = {}, model = {}, folder = {};
    std::size_t width = 0, height = 0;
    std::size_t renormalised = 0;              ///< normals whose length was off by more than 5 %
    std::vector<std::string> parameters = {};  ///< of the lobe
    std::size_t nodes = 1;
    double nodeError = 0;  ///< of D between them, relative to its norm, at most
    std::string form = {};
    int order = 0;  ///< of harmonics
    std::size_t numbers = 0, weights = 0, albedos = 0;
    std::vector<FilteredChoice> choices = {};
    std::vector<FilteredLevel> levels = {};
    std::size_t bytes = 0;
    std::size_t processes = 1;
    double seconds = 0, rate = 0;  ///< of writing; texels of level 0 per second
    std::vector<std::string> files = {};
};

/// Whether a description turns its texels, by normals or directions.
bool turnsTexels(const std::string& description);

/// A description of materials as textures of filtered lobes in FOLDER: material.ktx2 with all
/// levels, harmonics.ktx2 where the form has them, material.json and errors.png
/// (docs/explanation/filtered_maps.md). All maps are read and checked before anything is written.
/// Results are the same bytes for any number of threads and processes (map_processes.h). Throws
/// UsageError, InputError, NumericError and OutputError.
FilteredMapAnswer filteredMap(const std::string& description, const std::string& folder,
                              const FilteredMapOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
