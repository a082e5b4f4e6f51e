#pragma once

#include <brdfs/catalog.h>
#include <hshfit/stability/error_trials.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Draws that are the same on every machine: of the standard library, only the generator is.
class Draws {
public:
    explicit Draws(std::uint64_t seed) : generator_(seed) {}
    double between(double low, double high);     ///< evenly
    double logBetween(double low, double high);  ///< evenly in the logarithm, 0 < low
    std::size_t below(std::size_t count);
    bool oneIn(std::size_t count) { return below(count) == 0; }

private:
    std::mt19937_64 generator_;
};

/// Where parameters are drawn from: `mixed` are their whole ranges and, as often, those that fits
/// start from; `typical` the latter alone, where a parameter has one.
enum class DrawFrom { mixed, typical };

/// A specification of the model. Optional parameters are left out in half of the cases.
std::string randomSpec(const Model& model, Draws& draws, DrawFrom from = DrawFrom::mixed);

struct RandomCasesOptions {
    std::size_t count = 2000;
    std::uint64_t seed = 1;
    std::size_t tablesPerFormat = 3;
    /// Names of writers; empty: all whose files are read back.
    std::vector<std::string> formats = {};
    int maxOrder = 12;
    /// Names of models and formats whose cases are kept, each as it is among all; empty: all.
    std::vector<std::string> only = {};
};

/// Projections over the whole catalog, one of each model and of each format that can be written and
/// read back in turn: random parameters, elevation to 89 degrees, azimuth, basis, order and
/// quantity. Tables are written from typical models into files that are gone once this returns;
/// each case states the command that writes its own again. Throws UsageError for a name among
/// `only` that no model or format with cases has, OutputError where a table cannot be written.
std::vector<stability::ErrorTrial> randomCases(const RandomCasesOptions& options);

}  // namespace hshfit::brdfs
