#pragma once

#include <hshfit/material_library/log_space.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::material_library {

/// The mean and the components that materials share. A channel is
///     ln(f + logOffset) = mean + sum over k of scale * step * q_k * component_k
/// with whole numbers q_k of widths_k bits, |q_k| < 2^(widths_k - 1): the components have length 1
/// in the metric of LogSamples, so that one step has the same error in each, and a component takes
/// the bits that its spread needs. The scale is the channel's own: a material near the mean takes
/// smaller steps than one that needs all bits of its components.
struct Basis {
    std::vector<double> mean;          ///< [term], float32 in files
    std::vector<double> components;    ///< [component][term], half precision in files
    std::vector<std::uint8_t> widths;  ///< [component], from 2 to 16
    double step = 1;                   ///< float32 in files
    bool scaled = false;  ///< whether codes have scales; in files of version 1 all are 1

    std::size_t size() const { return widths.size(); }
    /// Bytes of one channel: its bound, then the bits of the scale and of all components.
    std::size_t channelBytes() const;
    /// Bytes of the arrays above in a file.
    std::size_t bytes() const;
};

/// The scale of a code: 1/2, 3/4, 1 or 3/2.
double stepScale(unsigned code);
inline constexpr unsigned plainScale = 2, scaleCodes = 4;  ///< the code of the scale 1; all codes
inline constexpr int scaleBits = 2;

/// Codes of one channel: the bound in steps of a twelfth of ln(f + logOffset), rounded up; then the
/// code `scale` and q_k + 2^(widths_k - 1), the lowest bit first. `coordinates` beyond the widths
/// become the nearest. Without scales, `scale` has to be plainScale.
std::vector<std::uint8_t> pack(const Basis& basis, std::span<const double> coordinates, double top,
                               unsigned scale = plainScale);

struct ChannelCode {
    std::vector<double> coordinates;  ///< scale * step * q_k
    double top = 0;
    unsigned scale = plainScale;  ///< the code of the scale
};
/// The inverse of `pack`, of basis.channelBytes() bytes.
ChannelCode unpack(const Basis& basis, std::span<const std::uint8_t> code);

/// The channels of a material from their codes, one after another.
LogMaterial decode(const Basis& basis, std::span<const std::uint8_t> codes);

/// The bound of a channel whose code begins with `code`: ln(logOffset) + code / topsPerLog.
inline constexpr double topsPerLog = 12;

/// The codes of materials in a basis: the least of
///     |d|^2 + sum of u d^2 + 2 sum of w d^2 + 48 sum of v e^2
/// over channels, d the error of ln(f + logOffset): the first in the metric of `space`, u over
/// pairs as (f cos)^2, with a sum of 1, which is relative L2 to first order, w over lit pixels as
/// pictures of the material see a channel, and e the difference of their colours that FLIP sees
/// (SeenPairs). The coordinates of all channels are rounded together (leastInSteps), in steps of
/// the scale with the least sum. `space` has to outlive this.
class Encoder {
public:
    Encoder(const Basis& basis, const LogSpace& space);
    ~Encoder();

    /// The codes of all channels; coordinates from `components` on are 0.
    std::vector<std::uint8_t> encode(const LogMaterial& material, std::size_t components) const;

private:
    struct Metric;

    const Basis& basis_;
    std::unique_ptr<const Metric> metric_;
};

/// Root of the weighted mean square of the difference of ln(f + logOffset), over channels.
double distance(const LogSpace& space, const LogMaterial& a, const LogMaterial& b);

}  // namespace hshfit::material_library
