#pragma once

#include <hshfit/accuracy/health.h>
#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <limits>
#include <optional>
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

/// Samples of pairs of directions that were measured in both orders.
struct BothOrders {
    std::size_t pairs = 0;
    double defect = 0;        ///< Health::reciprocityDefect of these samples
    double largestRatio = 1;  ///< of a value to the one of the exchanged pair, both above 0
    std::optional<Health::Exchange> worst = {};
};

/// A BRDF made of stored values.
class MeasuredBrdf : public Brdf {
public:
    /// Reads all stored values.
    virtual Census census() const = 0;
    /// The coordinates of a table; for scattered samples, the range of the samples.
    virtual std::vector<Axis> axes() const = 0;
    /// None where no pair was measured in both orders, or the format does not tell.
    virtual std::optional<BothOrders> bothOrders() const { return std::nullopt; }

    /// As checkIntact(), but stored NaN values count as missing. It serves callers that report
    /// them or fill them in.
    virtual void checkReadable() const { checkIntact(); }
};

}  // namespace hshfit::brdfs
