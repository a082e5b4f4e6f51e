#include <hshfit/gpu/containers/block_texels.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::size_t blockTexels = 16;
using Block = std::array<BlockTexel, blockTexels>;
using BlockBytes = std::array<std::uint8_t, 16>;

/// Fields of a block, the lowest bit first.
class BitWriter {
public:
    explicit BitWriter(std::span<std::uint8_t> out) : out_(out) {}
    void put(unsigned value, int bits) {
        for (int k = 0; k < bits; ++k, ++at_)
            if ((value >> k & 1U) != 0)
                out_[at_ / 8] = static_cast<std::uint8_t>(out_[at_ / 8] | 1U << at_ % 8);
    }

private:
    std::span<std::uint8_t> out_;
    std::size_t at_ = 0;
};

/// A channel between two bounds, high > low or both equal.
struct ChannelFit {
    int high = 0, low = 0;
    std::array<unsigned, blockTexels> codes{};
    double error = std::numeric_limits<double>::infinity();
};

float channelValue(int high, int low, unsigned code) {
    const int steps = code == 0 ? 7 : code == 1 ? 0 : 8 - static_cast<int>(code);
    return static_cast<float>(steps * high + (7 - steps) * low) / (7 * 255.F);
}

ChannelFit channelBetween(const std::array<float, blockTexels>& values, int high, int low) {
    ChannelFit fit{.high = high, .low = low, .codes = {}, .error = 0};
    for (std::size_t k = 0; k < blockTexels; ++k) {
        float least = std::numeric_limits<float>::infinity();
        for (unsigned code = 0; code < (high > low ? 8U : 1U); ++code) {
            const float gap = std::abs(channelValue(high, low, code) - values[k]);
            if (gap < least) least = gap, fit.codes[k] = code;
        }
        fit.error += static_cast<double>(least) * least;
    }
    return fit;
}

/// BC4: bounds about the extremes, each moved by up to three steps inwards.
ChannelFit bestChannel(const std::array<float, blockTexels>& values) {
    const auto [low, high] = std::ranges::minmax(values);
    const int least = static_cast<int>(std::floor(255 * low)),
              most = static_cast<int>(std::ceil(255 * high));
    ChannelFit best;
    for (int up = 0; up <= 3; ++up) {
        for (int down = 0; down <= 3; ++down) {
            if (least + up > most - down) continue;
            const ChannelFit fit = channelBetween(values, most - down, least + up);
            if (fit.error < best.error) best = fit;
        }
    }
    return best;
}

void encodeBc5(Block& block, std::span<std::uint8_t> out) {
    for (std::size_t c = 0; c < 2; ++c) {
        std::array<float, blockTexels> values{};
        for (std::size_t k = 0; k < blockTexels; ++k) values[k] = block[k][c];
        const ChannelFit fit = bestChannel(values);
        BitWriter bits(out.subspan(8 * c, 8));
        bits.put(static_cast<unsigned>(fit.high), 8);
        bits.put(static_cast<unsigned>(fit.low), 8);
        for (const unsigned code : fit.codes) bits.put(code, 3);
        for (std::size_t k = 0; k < blockTexels; ++k)
            block[k][c] = channelValue(fit.high, fit.low, fit.codes[k]);
    }
    for (BlockTexel& texel : block) texel[2] = 0, texel[3] = 1;
}

constexpr std::array<int, 16> shares{0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

/// The colours of mode 6: seven bits a channel, and a lowest bit for all of them.
struct ColourEnd {
    std::array<int, 4> upper{};
    int lowest = 0;

    int channel(std::size_t c) const { return 2 * upper[c] + lowest; }
};

ColourEnd colourEnd(const BlockTexel& colour, int lowest) {
    ColourEnd end{.upper = {}, .lowest = lowest};
    for (std::size_t c = 0; c < 4; ++c) {
        const double wanted = (255.0 * static_cast<double>(colour[c]) - lowest) / 2;
        end.upper[c] = static_cast<int>(std::clamp(std::round(wanted), 0.0, 127.0));
    }
    return end;
}

float mixed(const ColourEnd& a, const ColourEnd& b, std::size_t c, unsigned code) {
    const int share = shares[code];
    return static_cast<float>(((64 - share) * a.channel(c) + share * b.channel(c) + 32) >> 6) /
           255.F;
}

struct ColourFit {
    ColourEnd a, b;
    std::array<unsigned, blockTexels> codes{};
    double error = std::numeric_limits<double>::infinity();
};

ColourFit coloursBetween(const Block& block, const ColourEnd& a, const ColourEnd& b) {
    ColourFit fit{.a = a, .b = b, .codes = {}, .error = 0};
    for (std::size_t k = 0; k < blockTexels; ++k) {
        double least = std::numeric_limits<double>::infinity();
        for (unsigned code = 0; code < shares.size(); ++code) {
            double gap = 0;
            for (std::size_t c = 0; c < 4; ++c)
                gap += std::pow(static_cast<double>(mixed(a, b, c, code) - block[k][c]), 2);
            if (gap < least) least = gap, fit.codes[k] = code;
        }
        fit.error += least;
    }
    return fit;
}

/// The nearest of the four pairs of lowest bits.
ColourFit nearestEnds(const Block& block, const BlockTexel& a, const BlockTexel& b) {
    ColourFit best;
    for (int lowest = 0; lowest < 4; ++lowest) {
        const ColourFit fit =
            coloursBetween(block, colourEnd(a, lowest & 1), colourEnd(b, lowest >> 1));
        if (fit.error < best.error) best = fit;
    }
    return best;
}

/// The ends of the line through the mean along which colours vary most.
std::pair<BlockTexel, BlockTexel> principalEnds(const Block& block) {
    std::array<double, 4> mean{}, axis{1, 1, 1, 1};
    for (const BlockTexel& texel : block)
        for (std::size_t c = 0; c < 4; ++c) mean[c] += static_cast<double>(texel[c]) / blockTexels;
    const auto along = [&](const BlockTexel& texel) {
        double sum = 0;
        for (std::size_t c = 0; c < 4; ++c)
            sum += axis[c] * (static_cast<double>(texel[c]) - mean[c]);
        return sum;
    };
    constexpr int rounds = 12;
    for (int round = 0; round < rounds; ++round) {
        std::array<double, 4> next{};
        for (const BlockTexel& texel : block)
            for (std::size_t c = 0; c < 4; ++c)
                next[c] += along(texel) * (static_cast<double>(texel[c]) - mean[c]);
        const double length =
            std::hypot(std::hypot(next[0], next[1]), std::hypot(next[2], next[3]));
        if (!(length > 0)) break;
        for (std::size_t c = 0; c < 4; ++c) axis[c] = next[c] / length;
    }
    double low = 0, high = 0;
    for (const BlockTexel& texel : block)
        low = std::min(low, along(texel)), high = std::max(high, along(texel));
    BlockTexel a{}, b{};
    for (std::size_t c = 0; c < 4; ++c) {
        a[c] = static_cast<float>(std::clamp(mean[c] + low * axis[c], 0.0, 1.0));
        b[c] = static_cast<float>(std::clamp(mean[c] + high * axis[c], 0.0, 1.0));
    }
    return {a, b};
}

/// The ends that are nearest for given codes, by least squares.
std::pair<BlockTexel, BlockTexel> refinedEnds(const Block& block, const ColourFit& fit) {
    double aa = 0, ab = 0, bb = 0;
    std::array<double, 4> ta{}, tb{};
    for (std::size_t k = 0; k < blockTexels; ++k) {
        const double b = shares[fit.codes[k]] / 64.0, a = 1 - b;
        aa += a * a, ab += a * b, bb += b * b;
        for (std::size_t c = 0; c < 4; ++c) {
            ta[c] += a * static_cast<double>(block[k][c]);
            tb[c] += b * static_cast<double>(block[k][c]);
        }
    }
    BlockTexel a{}, b{};
    const double determinant = aa * bb - ab * ab;
    for (std::size_t c = 0; c < 4; ++c) {
        const bool flat = !(determinant > 1e-9);
        const double x = flat ? fit.a.channel(c) / 255.0 : (bb * ta[c] - ab * tb[c]) / determinant;
        const double y = flat ? fit.b.channel(c) / 255.0 : (aa * tb[c] - ab * ta[c]) / determinant;
        a[c] = static_cast<float>(std::clamp(x, 0.0, 1.0));
        b[c] = static_cast<float>(std::clamp(y, 0.0, 1.0));
    }
    return {a, b};
}

void encodeBc7(Block& block, std::span<std::uint8_t> out) {
    const auto [low, high] = principalEnds(block);
    ColourFit best = nearestEnds(block, low, high);
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
        const auto [a, b] = refinedEnds(block, best);
        const ColourFit fit = nearestEnds(block, a, b);
        if (!(fit.error < best.error)) break;
        best = fit;
    }
    // The first code has three bits: its highest is 0.
    if (best.codes[0] > 7) {
        std::swap(best.a, best.b);
        for (unsigned& code : best.codes) code = 15 - code;
    }
    BitWriter bits(out);
    bits.put(1U << 6, 7);
    for (std::size_t c = 0; c < 4; ++c) {
        bits.put(static_cast<unsigned>(best.a.upper[c]), 7);
        bits.put(static_cast<unsigned>(best.b.upper[c]), 7);
    }
    bits.put(static_cast<unsigned>(best.a.lowest), 1);
    bits.put(static_cast<unsigned>(best.b.lowest), 1);
    for (std::size_t k = 0; k < blockTexels; ++k) bits.put(best.codes[k], k == 0 ? 3 : 4);
    for (std::size_t k = 0; k < blockTexels; ++k)
        for (std::size_t c = 0; c < 4; ++c) block[k][c] = mixed(best.a, best.b, c, best.codes[k]);
}

}  // namespace

BlockPicture encodeBlocks(Blocks blocks, std::span<const BlockTexel> texels, std::size_t width,
                          std::size_t height) {
    assert(blocks != Blocks::none && texels.size() == width * height);
    BlockPicture picture{.bytes = {}, .decoded = std::vector<BlockTexel>(texels.size())};
    for (std::size_t top = 0; top < height; top += 4) {
        for (std::size_t left = 0; left < width; left += 4) {
            Block block{};
            for (std::size_t k = 0; k < blockTexels; ++k) {
                const std::size_t row = std::min(height - 1, top + k / 4),
                                  column = std::min(width - 1, left + k % 4);
                block[k] = texels[row * width + column];
            }
            BlockBytes bytes{};
            blocks == Blocks::bc5 ? encodeBc5(block, bytes) : encodeBc7(block, bytes);
            for (const std::uint8_t byte : bytes) picture.bytes.push_back(std::byte{byte});
            for (std::size_t k = 0; k < blockTexels; ++k)
                if (top + k / 4 < height && left + k % 4 < width)
                    picture.decoded[(top + k / 4) * width + left + k % 4] = block[k];
        }
    }
    return picture;
}

}  // namespace hshfit::gpu::inline containers
