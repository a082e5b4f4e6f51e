#include <hshfit/material_maps/texel_encoder.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::inline material_maps {
namespace {

/// Texels of 4 * layers floats at multiples of `stride`, into layers.
EncodedRange stored(std::span<const float> values, std::size_t stride, std::size_t layers,
                    gpu::Number number, const EncodedTexels& to) {
    const std::size_t count = values.size() / stride;
    if (number == gpu::Number::float16) {
        const HalfRange range =
            toHalfLayers(values.data(), stride, count, layers,
                         reinterpret_cast<std::uint16_t*>(to.bytes), to.pitch / 8);
        return {range.largest, range.finite && range.largest <= 65504};
    }
    EncodedRange result;
    for (std::size_t t = 0; t < count; ++t) {
        for (std::size_t k = 0; k < layers; ++k) {
            const float* quadruple = values.data() + t * stride + 4 * k;
            for (int i = 0; i < 4; ++i) {
                result.largest = std::max(result.largest, std::abs(quadruple[i]));
                result.finite = result.finite && std::isfinite(quadruple[i]);
            }
            std::memcpy(to.bytes + k * to.pitch + t * 16, quadruple, 16);
        }
    }
    return result;
}

}  // namespace

double normOfReduced(const float* linear, std::size_t weights) {
    double square = 0;
    for (std::size_t k = 0; k <= weights; ++k)
        square += static_cast<double>(linear[k]) * static_cast<double>(linear[k]);
    return std::sqrt(square);
}

float relativeError(double error, double norm) {
    return norm > 0 ? static_cast<float>(error / norm) : 0;
}

PlainEncoder::PlainEncoder(const TexelLayout& layout, gpu::Number number)
    : layers_(layout.layers()), number_(number) {}

void PlainEncoder::reduce(const float* texel, float* linear) const {
    std::copy_n(texel, this->linear(), linear);
}

EncodedRange PlainEncoder::encode(std::size_t, std::span<const float> linear,
                                  const EncodedTexels& to) const {
    std::fill_n(to.errors, linear.size() / this->linear(), 0.0F);
    return stored(linear, this->linear(), layers_, number_, to);
}

LowRankEncoder::LowRankEncoder(LowRank lowRank, gpu::Number number)
    : lowRank_(std::move(lowRank)), number_(number) {}

void LowRankEncoder::reduce(const float* texel, float* linear) const {
    std::fill_n(linear + lowRank_.weightsOfTexel(), 4 * layers() - lowRank_.weightsOfTexel(), 0.0F);
    linear[4 * layers()] = lowRank_.reduce(texel, linear);
}

EncodedRange LowRankEncoder::encode(std::size_t, std::span<const float> linear,
                                    const EncodedTexels& to) const {
    const std::size_t step = this->linear(), rest = step - 1;
    for (std::size_t t = 0; t < linear.size() / step; ++t) {
        const float* texel = linear.data() + t * step;
        to.errors[t] = relativeError(static_cast<double>(texel[rest]), normOfReduced(texel, rest));
    }
    return stored(linear, step, layers(), number_, to);
}

}  // namespace hshfit::inline material_maps
