#pragma once

#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// The index of refraction n + i k at a wavelength.
struct MetalRow {
    double nanometres, n, k;
};

/// Optical constants of a metal at room temperature, as a paper tabulates them.
struct Metal {
    std::string_view name;
    std::string_view help;           ///< its symbol, a comma, and its wavelengths
    std::string_view source;         ///< author, year, DOI
    std::span<const MetalRow> rows;  ///< by ascending wavelengths

    std::string_view symbol() const { return help.substr(0, help.find(',')); }
};

/// The table of named metals, in the order in which they are listed.
std::span<const Metal> metals();

/// By its name or symbol. Throws UsageError with the known names.
const Metal& findMetal(std::string_view name);

/// n and k, linear in the wavelength between the rows of the table. Throws UsageError outside of
/// the table, with its ends.
MetalRow indexAt(const Metal& metal, double nanometres);

}  // namespace hshfit::brdfs
