#pragma once

#include <brdfs/rows/spec.h>
#include <hshfit/brdf/brdf.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The quantities that a polarimetric file is read as: elements M_rc of its Mueller matrices, which
/// map the Stokes vector (I, Q, U, V) of the light that arrives to that which leaves, in 1/sr; and
/// the degree of linear polarisation of what unpolarised light becomes,
///     dolp = sqrt(M_10^2 + M_20^2) / M_00,
/// without unit and 0 where M_00 is not above 0. Elements are counted from 0, so that M_00 is the
/// BRDF for unpolarised light. Q and U refer to axes of the file's own.
class MuellerElements {
public:
    using Matrix = std::array<double, 16>;  ///< row after row

    /// `text`: "m00" to "m33" and "dolp", joined by '/' in any order, or "all" for the 16 elements.
    /// Throws UsageError for another word, or one that is there twice.
    explicit MuellerElements(std::string text = "m00");

    const std::string& text() const { return text_; }
    /// Whether M_00 is all that is read.
    bool isReflectance() const { return names_ == std::vector<std::string>{"m00"}; }
    bool isPositive(std::size_t k) const { return names_[k] == "m00" || names_[k] == "dolp"; }
    bool arePositive() const;
    std::size_t size() const { return names_.size(); }
    /// In the order of the matrix, row after row, then dolp.
    const std::vector<std::string>& names() const { return names_; }
    /// The places in a matrix, ascending, of the elements that quantity `k`, or any, is made of.
    std::vector<std::size_t> places(std::size_t k) const;
    std::vector<std::size_t> places() const;
    /// Quantity `k` of a matrix that has the elements at its places. M_00 is at least 0.
    double value(std::size_t k, const Matrix& matrix) const;
    /// `wavelengths` of M_00 alone; else the names, each at all of them.
    Channels channels(Channels wavelengths) const;

private:
    std::string text_;
    std::vector<std::string> names_;
};

/// The option `mueller` of polarimetric formats.
Parameter muellerParameter();
MuellerElements muellerElements(const Parameters& parameters);

/// The line of `info` for what is read.
Fact muellerFact(const MuellerElements& elements);
/// Throws InputError, in one line, for channels that are no reflectance: `taker`, such as "fit",
/// needs one.
void requireReflectance(const std::string& name, const Channels& channels, const char* taker);
inline void requireReflectance(const Brdf& brdf, const char* taker) {
    requireReflectance(brdf.name(), brdf.channels(), taker);
}

}  // namespace hshfit::brdfs
