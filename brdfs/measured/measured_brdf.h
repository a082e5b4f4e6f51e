#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Statistics of the stored values of a file (a channel of a cell is a value).
struct Census {
    std::uint64_t values = 0;        ///< stored in the file
    std::uint64_t belowHorizon = 0;  ///< in cells with a direction below the horizon
    /// The rest are values above the horizon.
    std::uint64_t invalid = 0;   ///< marked as not measured by the format's own convention
    std::uint64_t negative = 0;  ///< below zero and not such a mark
    std::uint64_t notANumber = 0, infinite = 0;
    /// Over the finite values above the horizon that are not marked invalid, as f in 1/sr.
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();

    /// Counts one value of a cell above the horizon that is not marked invalid.
    void add(double value);
};

/// The sampling of one coordinate.
struct Axis {
    std::string name;  ///< "theta_half", "phi_i", "wavelength", …
    std::string unit;  ///< "degrees" or "nm"
    std::size_t count = 0;
    double first = 0, last = 0;
    double largestGap = 0;  ///< between neighbouring nodes
};

/// A BRDF made of stored values.
class MeasuredBrdf : public Brdf {
public:
    /// Reads all stored values.
    virtual Census census() const = 0;
    /// The coordinates of a table; for scattered samples, the range of the samples.
    virtual std::vector<Axis> axes() const = 0;

    /// As checkIntact(), but stored NaN values count as missing. It serves callers that report
    /// them or fill them in.
    virtual void checkReadable() const { checkIntact(); }
};

}  // namespace hshfit::brdfs
