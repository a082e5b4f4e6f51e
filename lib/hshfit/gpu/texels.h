#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {
class JsonFields;
}

namespace hshfit::gpu {

/// The encoding of a number in a texel; little-endian.
enum class Number {
    float16,  ///< IEEE binary16, nearest even; up to 65504
    float32,
    unorm16,  ///< integer / 65535, times a scale plus an offset per layer and lane
    unorm8,   ///< integer / 255, likewise
};
std::string numberName(Number number);  ///< "float16", …, as in files
std::size_t numberBytes(Number number);
bool isNormalised(Number number);
/// Throws UsageError with the four names.
Number parseNumber(std::string_view name);
/// The number type that a file names; throws InputError with the field and the four names.
Number numberIn(const JsonFields& fields, const char* key);

/// value = stored * scale + offset.
struct LaneScale {
    double scale = 1, offset = 0;
};

/// An array of RGBA textures: number ((layer * height + y) * width + x) * 4 + lane, row 0 being
/// v = 0 in memory, unused lanes 0.
struct Texels {
    int width = 1, height = 1;
    std::size_t layers = 0;
    Number number = Number::float16;
    std::vector<std::byte> bytes;
    std::vector<LaneScale> scales;  ///< [layer * 4 + lane]; empty unless normalised

    std::size_t count() const {
        return layers * static_cast<std::size_t>(height) * static_cast<std::size_t>(width) * 4;
    }
};

/// Encodes values laid out as in `Texels`. Scales of normalised numbers span each lane's range.
/// Throws NumericError where a value is not finite or beyond the number's range.
Texels encode(std::span<const double> values, int width, int height, std::size_t layers,
              Number number);
/// The values that a GPU reads. Throws InputError where `bytes` or `scales` have another length
/// than the sizes say.
std::vector<double> decode(const Texels& texels);
/// The same as every API's textures take them: unorm16, which is no core format, as float32 of the
/// quotients that a sampler would return. Scales and offsets stay with the shader.
Texels samplerTexels(const Texels& texels);

}  // namespace hshfit::gpu
