#pragma once

#include <hshfit/brdf/brdf.h>

#include <span>

namespace hshfit::inline brdf {

/// A BRDF whose values at a pair of directions are combinations of another's channels there: its
/// colours, or their mean. The samples behind that BRDF, converted value by value, are therefore
/// the samples behind this one.
class ChannelView {
public:
    virtual const Brdf& seen() const = 0;
    /// `from`: a value per channel of `seen()`; `to`: one per channel of this.
    virtual void convert(std::span<const double> from, std::span<double> to) const = 0;

protected:
    ~ChannelView() = default;
};

}  // namespace hshfit::inline brdf
