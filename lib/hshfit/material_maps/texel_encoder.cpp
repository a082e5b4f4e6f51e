#include <hshfit/material_maps/texel_encoder.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::inline material_maps {
namespace {

/// Quadruples of floats, [texel][4 * layers], into layers.
EncodedTexels stored(const float* values, std::size_t count, std::size_t layers, gpu::Number number,
                     std::byte* out, std::size_t pitch) {
    EncodedTexels result{.errors = std::vector<float>(count)};
    if (number == gpu::Number::float16) {
        const HalfRange range =
            toHalfLayers(values, count, layers, reinterpret_cast<std::uint16_t*>(out), pitch / 8);
        result.largest = range.largest;
        result.finite = range.finite && range.largest <= 65504;
        return result;
    }
    for (std::size_t t = 0; t < count; ++t) {
        for (std::size_t k = 0; k < layers; ++k) {
            const float* quadruple = values + (t * layers + k) * 4;
            for (int i = 0; i < 4; ++i) {
                result.largest = std::max(result.largest, std::abs(quadruple[i]));
                result.finite = result.finite && std::isfinite(quadruple[i]);
            }
            std::memcpy(out + k * pitch + t * 16, quadruple, 16);
        }
    }
    return result;
}

double normOf(const float* weights, std::size_t count) {
    double square = 0;
    for (std::size_t k = 0; k < count; ++k)
        square += static_cast<double>(weights[k]) * static_cast<double>(weights[k]);
    return std::sqrt(square);
}

/// An error relative to the norm of weights and rest; black is exact.
float relative(double error, double weights, double rest) {
    const double norm = std::hypot(weights, rest);
    return norm > 0 ? static_cast<float>(error / norm) : 0;
}

}  // namespace

PlainEncoder::PlainEncoder(const TexelLayout& layout, gpu::Number number)
    : layers_(layout.layers()), number_(number) {}

void PlainEncoder::reduce(const float* texel, float* linear) const {
    std::copy_n(texel, this->linear(), linear);
}

EncodedTexels PlainEncoder::encode(const float* linear, std::size_t count, std::byte* out,
                                   std::size_t pitch) const {
    return stored(linear, count, layers_, number_, out, pitch);
}

LowRankEncoder::LowRankEncoder(LowRank lowRank, gpu::Number number)
    : lowRank_(std::move(lowRank)), number_(number) {}

void LowRankEncoder::reduce(const float* texel, float* linear) const {
    std::fill_n(linear + lowRank_.weightsOfTexel(), 4 * layers() - lowRank_.weightsOfTexel(), 0.0F);
    linear[4 * layers()] = lowRank_.reduce(texel, linear);
}

EncodedTexels LowRankEncoder::encode(const float* linear, std::size_t count, std::byte* out,
                                     std::size_t pitch) const {
    const std::size_t step = this->linear(), kept = 4 * layers();
    std::vector<float> weights(count * kept);
    for (std::size_t t = 0; t < count; ++t)
        std::copy_n(linear + t * step, kept, weights.data() + t * kept);
    EncodedTexels result = stored(weights.data(), count, layers(), number_, out, pitch);
    for (std::size_t t = 0; t < count; ++t) {
        const auto rest = static_cast<double>(linear[t * step + kept]);
        result.errors[t] = relative(rest, normOf(linear + t * step, kept), rest);
    }
    return result;
}

ClusterEncoder::ClusterEncoder(LowRank lowRank, std::vector<float> centres)
    : lowRank_(std::move(lowRank)),
      centres_(std::move(centres)),
      nearest_(centres_, lowRank_.weightsOfTexel()) {}

void ClusterEncoder::reduce(const float* texel, float* linear) const {
    linear[lowRank_.weightsOfTexel()] = lowRank_.reduce(texel, linear);
}

EncodedTexels ClusterEncoder::encode(const float* linear, std::size_t count, std::byte* out,
                                     std::size_t) const {
    EncodedTexels result{.errors = std::vector<float>(count)};
    const std::size_t weights = lowRank_.weightsOfTexel();
    for (std::size_t t = 0; t < count; ++t) {
        const float* point = linear + t * (weights + 1);
        const Nearest nearest = nearest_(point);
        const auto rest = static_cast<double>(point[weights]);
        const double off = std::sqrt(static_cast<double>(nearest.square) + rest * rest);
        result.errors[t] = relative(off, normOf(point, weights), rest);
        result.finite = result.finite && std::isfinite(off);
        const auto code = static_cast<std::uint32_t>(
            std::clamp(std::ceil(static_cast<double>(result.errors[t]) * 65535), 0.0, 65535.0));
        const std::uint32_t bytes[] = {nearest.index & 255, nearest.index >> 8, code & 255,
                                       code >> 8};
        for (std::size_t k = 0; k < 4; ++k) out[4 * t + k] = static_cast<std::byte>(bytes[k]);
    }
    result.largest = result.errors.empty() ? 0 : *std::ranges::max_element(result.errors);
    return result;
}

}  // namespace hshfit::inline material_maps
