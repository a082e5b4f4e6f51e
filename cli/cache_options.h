#pragma once

#include <hshfit/transport/radiance_cache/cache.h>

#include <jobs/scenes/illuminate.h>

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace hshfit::cli {

/// Options of a radiance cache as they are parsed.
struct CacheArguments {
    CacheOptions options = {};
    std::string direct = "sampled", gradient = "strata", choice = "cost";
    std::vector<std::string> without = {};
    double megabytes = 1e-6 * static_cast<double>(jobs::defaultCacheBytes);
    bool published = false;
    std::vector<CLI::Option*> all = {};
};

/// Adds them to a command; they have to outlive it.
void addCacheOptions(CLI::App& command, CacheArguments& arguments);
/// The settings, after parsing.
CacheOptions cacheOptionsOf(const CacheArguments& arguments);
/// Throws UsageError that names the first of them that was given.
void refuseCacheOptions(const CacheArguments& arguments, const std::string& method);

}  // namespace hshfit::cli
