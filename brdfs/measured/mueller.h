#pragma once

#include <brdfs/rows/spec.h>
#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The quantity that a polarimetric file is read as: an element M_rc of its Mueller matrices, which
/// map the Stokes vector (I, Q, U, V) of the light that arrives to that which leaves, in 1/sr; or
/// the degree of linear polarisation of what unpolarised light becomes,
///     dolp = sqrt(M_10^2 + M_20^2) / M_00,
/// without unit and 0 where M_00 is not above 0. Elements are counted from 0, so that M_00 is the
/// BRDF for unpolarised light. Q and U refer to axes of the file's own.
class MuellerElement {
public:
    MuellerElement() = default;
    /// `name`: "m00" to "m33", or "dolp".
    explicit MuellerElement(std::string name);

    const std::string& name() const { return name_; }
    bool isReflectance() const { return name_ == "m00"; }
    bool isDegree() const { return name_ == "dolp"; }
    /// The places in a matrix, row after row, of the elements that it is made of.
    const std::vector<std::size_t>& places() const { return places_; }
    /// The element from the values at these places. M_00 is at least 0.
    double value(const double* values) const;

private:
    std::string name_ = "m00";
    std::vector<std::size_t> places_ = {0};
};

/// The option `mueller` of polarimetric formats.
Parameter muellerParameter();
MuellerElement muellerElement(const Parameters& parameters);

/// The line of `info` for what is read.
Fact muellerFact(const MuellerElement& element);
/// Throws InputError, with the name of the command, for what muellerFact() says is no reflectance.
void requireReflectance(const Brdf& brdf, const char* command);

}  // namespace hshfit::brdfs
