#pragma once

#include <brdfs/fit/fit_samples.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::brdfs {

/// The samples of each scan; without scans each sample is one.
std::vector<std::vector<std::size_t>> scanMembers(const FitSamples& samples);

/// The number of times that each of `count` samples comes in as many scans as there are, drawn with
/// replacement.
/// Draw `draw` depends on the seed and its number alone.
std::vector<std::size_t> timesDrawn(const std::vector<std::vector<std::size_t>>& members,
                                    std::size_t count, std::uint64_t seed, std::size_t draw);

/// The samples of draw `draw`: one that comes several times has that weight.
FitSamples redrawn(const FitSamples& samples, std::uint64_t seed, std::size_t draw);

}  // namespace hshfit::brdfs
