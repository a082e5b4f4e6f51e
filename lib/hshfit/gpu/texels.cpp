#include <hshfit/gpu/texels.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace hshfit::gpu {

static_assert(std::endian::native == std::endian::little, "texels are written little-endian");

namespace {

struct Format {
    Number number;
    const char* name;
    std::size_t bytes;
    double steps;  ///< largest integer of a normalised number; 0: floating point
};
constexpr std::array formats{
    Format{Number::float16, "float16", 2, 0},
    Format{Number::float32, "float32", 4, 0},
    Format{Number::unorm16, "unorm16", 2, 65535},
    Format{Number::unorm8, "unorm8", 1, 255},
};
const Format& formatOf(Number number) {
    return *std::find_if(formats.begin(), formats.end(),
                         [&](const Format& row) { return row.number == number; });
}

template <class Stored>
void put(std::vector<std::byte>& bytes, std::size_t index, Stored value) {
    std::memcpy(bytes.data() + index * sizeof(Stored), &value, sizeof(Stored));
}
template <class Stored>
Stored get(const std::vector<std::byte>& bytes, std::size_t index) {
    Stored value;
    std::memcpy(&value, bytes.data() + index * sizeof(Stored), sizeof(Stored));
    return value;
}

/// The range of each lane over its layer.
std::vector<LaneScale> laneScales(std::span<const double> values, const Texels& texels) {
    std::vector<LaneScale> scales(texels.layers * 4);
    const std::size_t pixels = texels.count() / scales.size();
    for (std::size_t k = 0; k < scales.size(); ++k) {
        const double* lane = values.data() + k / 4 * pixels * 4 + k % 4;
        double low = lane[0], high = lane[0];
        for (std::size_t p = 0; p < pixels; ++p) {
            low = std::min(low, lane[p * 4]);
            high = std::max(high, lane[p * 4]);
        }
        // Shaders hold scales in single precision, so that values are encoded with the rounded
        // scales.
        scales[k] = {static_cast<double>(static_cast<float>(high - low)),
                     static_cast<double>(static_cast<float>(low))};
    }
    return scales;
}

void encodeNormalised(std::span<const double> values, Texels& texels, double steps) {
    texels.scales = laneScales(values, texels);
    const std::size_t perLayer = values.size() / texels.layers;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const LaneScale& lane = texels.scales[i / perLayer * 4 + i % 4];
        const double unit = lane.scale > 0 ? (values[i] - lane.offset) / lane.scale : 0;
        const double rounded = std::nearbyint(std::clamp(unit, 0.0, 1.0) * steps);
        if (texels.number == Number::unorm8) {
            put(texels.bytes, i, static_cast<std::uint8_t>(rounded));
        } else {
            put(texels.bytes, i, static_cast<std::uint16_t>(rounded));
        }
    }
}

void encodeFloating(std::span<const double> values, Texels& texels) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float single = static_cast<float>(values[i]) + 0.0F;  // no negative zero
        if (texels.number == Number::float32) {
            put(texels.bytes, i, single);
        } else {
            put(texels.bytes, i, Imath::half(single).bits());
        }
    }
}

/// Rounding in two steps (double, float, half) differs from one step by at most half an ulp of
/// float, at a tie.
void checkRange(std::span<const double> values, Number number) {
    const double largest = number == Number::float16 ? 65504.0 : 3.4028234e38;
    for (const double value : values) {
        if (std::isfinite(value) && std::abs(value) <= largest) continue;
        throw NumericError(fmt::format(
            "a value of {} cannot be stored as {} (up to {:g}); {}", value, numberName(number),
            largest, number == Number::float16 ? "use float32 or unorm16" : "scale the BRDF down"));
    }
}

}  // namespace

std::string numberName(Number number) {
    return formatOf(number).name;
}

std::size_t numberBytes(Number number) {
    return formatOf(number).bytes;
}

bool isNormalised(Number number) {
    return formatOf(number).steps > 0;
}

Number parseNumber(std::string_view name) {
    for (const Format& row : formats) {
        if (name == row.name) return row.number;
    }
    throw UsageError(
        fmt::format("number type '{}'; known: float16, float32, unorm16, unorm8", name));
}

Number numberIn(const JsonFields& fields, const char* key) {
    try {
        return parseNumber(fields.word(key));
    } catch (const UsageError& error) {
        fields.fail(fmt::format("is invalid: {}", error.what()), key);
    }
}

Texels encode(std::span<const double> values, int width, int height, std::size_t layers,
              Number number) {
    Texels texels{width, height, layers, number, {}, {}};
    checkRange(values, number);
    texels.bytes.resize(texels.count() * numberBytes(number));
    const Format& format = formatOf(number);
    if (format.steps > 0) {
        encodeNormalised(values, texels, format.steps);
    } else {
        encodeFloating(values, texels);
    }
    return texels;
}

std::vector<double> decode(const Texels& texels) {
    const Format& format = formatOf(texels.number);
    if (texels.bytes.size() != texels.count() * format.bytes) {
        throw InputError(fmt::format("{} bytes of texels; {}x{}x{} RGBA {} make {}",
                                     texels.bytes.size(), texels.width, texels.height,
                                     texels.layers, format.name, texels.count() * format.bytes));
    }
    if (format.steps > 0 && texels.scales.size() != texels.layers * 4) {
        throw InputError(fmt::format("{} scales of {} texels; {} layers need {}",
                                     texels.scales.size(), format.name, texels.layers,
                                     texels.layers * 4));
    }
    std::vector<double> values(texels.count());
    const std::size_t perLayer = texels.layers ? values.size() / texels.layers : 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto normalised = [&](double stored) {
            const LaneScale& lane = texels.scales[i / perLayer * 4 + i % 4];
            return stored / format.steps * lane.scale + lane.offset;
        };
        switch (texels.number) {
            case Number::float16: {
                Imath::half value;
                value.setBits(get<std::uint16_t>(texels.bytes, i));
                values[i] = static_cast<double>(static_cast<float>(value));
                break;
            }
            case Number::float32:
                values[i] = static_cast<double>(get<float>(texels.bytes, i));
                break;
            case Number::unorm16:
                values[i] = normalised(get<std::uint16_t>(texels.bytes, i));
                break;
            case Number::unorm8:
                values[i] = normalised(get<std::uint8_t>(texels.bytes, i));
                break;
        }
    }
    return values;
}

Texels samplerTexels(const Texels& texels) {
    if (texels.number != Number::unorm16) return texels;
    Texels result = texels;
    result.number = Number::float32;
    result.scales.clear();
    result.bytes.resize(2 * texels.bytes.size());
    for (std::size_t k = 0; k < texels.count(); ++k) {
        std::uint16_t stored = 0;
        std::memcpy(&stored, texels.bytes.data() + 2 * k, sizeof stored);
        const float value = static_cast<float>(stored) / 65535.0F;
        std::memcpy(result.bytes.data() + 4 * k, &value, sizeof value);
    }
    return result;
}

}  // namespace hshfit::gpu
