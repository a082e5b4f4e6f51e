#include <hshfit/representation/stored_array.h>

#include <hshfit/byte_cursor.h>
#include <hshfit/checked_product.h>
#include <hshfit/error.h>
#include <hshfit/spelling.h>

#include <Imath/half.h>
#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace hshfit::inline representation {

static_assert(std::endian::native == std::endian::little, "arrays are packed little-endian");

namespace {

struct Row {
    Precision precision;
    std::string_view name;
    std::size_t bytes;
    double steps;    ///< largest integer of a normalised number; 0: floating point
    double largest;  ///< finite magnitude
};
constexpr std::array rows{
    Row{Precision::float64, "float64", 8, 0, std::numeric_limits<double>::max()},
    Row{Precision::float32, "float32", 4, 0, std::numeric_limits<float>::max()},
    Row{Precision::half, "half", 2, 0, 65504},
    Row{Precision::unorm16, "unorm16", 2, 65535, std::numeric_limits<float>::max()},
    Row{Precision::unorm8, "unorm8", 1, 255, std::numeric_limits<float>::max()},
};
const Row& rowOf(Precision precision) {
    return *std::find_if(rows.begin(), rows.end(),
                         [&](const Row& row) { return row.precision == precision; });
}

bool isKept(const StoredArray& array, std::size_t i) {
    return array.kept.empty() || array.kept[i];
}
std::size_t groupOf(const StoredArray& array, std::size_t i) {
    return i % array.columns() / array.groupColumns();
}

/// Scales and offsets that span the kept values of each group.
void spanGroups(StoredArray& array) {
    array.scales.assign(array.groups(), 0);
    array.offsets.assign(array.groups(), 0);
    std::vector<double> low(array.groups(), std::numeric_limits<double>::infinity());
    std::vector<double> high(array.groups(), -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        if (!isKept(array, i)) continue;
        const std::size_t g = groupOf(array, i);
        low[g] = std::min(low[g], array.values[i]);
        high[g] = std::max(high[g], array.values[i]);
    }
    for (std::size_t g = 0; g < array.groups(); ++g) {
        if (low[g] > high[g]) continue;
        array.offsets[g] = static_cast<float>(low[g]);
        array.scales[g] = static_cast<float>(high[g] - array.offsets[g]);
    }
}

double integerOf(const StoredArray& array, std::size_t i, double steps) {
    const std::size_t g = groupOf(array, i);
    if (array.scales[g] <= 0) return 0;
    const double unit = (array.values[i] - array.offsets[g]) / array.scales[g];
    return std::nearbyint(std::clamp(unit, 0.0, 1.0) * steps);
}
double valueOf(const StoredArray& array, std::size_t i, double integer, double steps) {
    const std::size_t g = groupOf(array, i);
    return array.offsets[g] + static_cast<double>(array.scales[g]) * integer / steps;
}

template <class Stored>
void append(std::vector<std::byte>& bytes, Stored value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(Stored));
}

std::size_t overhead(const StoredArray& array) {
    const std::size_t scales = rowOf(array.precision).steps > 0 ? array.groups() * 8 : 0;
    return scales + (array.kept.empty() ? 0 : (array.values.size() + 7) / 8);
}

}  // namespace

std::string_view precisionName(Precision precision) {
    return rowOf(precision).name;
}

Precision parsePrecision(std::string_view name) {
    for (const Row& row : rows) {
        if (row.name == name) return row.precision;
    }
    throw spelling::unknown("precision", name, spelling::namesOf(rows));
}

std::size_t numberBytes(Precision precision) {
    return rowOf(precision).bytes;
}

double largestInteger(Precision precision) {
    return rowOf(precision).steps;
}

std::size_t keptCount(const StoredArray& array) {
    if (array.kept.empty()) return array.values.size();
    return static_cast<std::size_t>(std::count(array.kept.begin(), array.kept.end(), true));
}

double takeNumber(ByteCursor& cursor, Precision precision) {
    switch (precision) {
        case Precision::float64:
            return *cursor.number<double>();
        case Precision::float32:
            return static_cast<double>(*cursor.number<float>());
        case Precision::half: {
            Imath::half value;
            value.setBits(*cursor.number<std::uint16_t>());
            return static_cast<double>(static_cast<float>(value));
        }
        case Precision::unorm16:
            return *cursor.number<std::uint16_t>();
        case Precision::unorm8:
            break;
    }
    return *cursor.number<std::uint8_t>();
}

void appendNumber(std::vector<std::byte>& bytes, Precision precision, double value) {
    switch (precision) {
        case Precision::float64:
            return append(bytes, value);
        case Precision::float32:
            return append(bytes, static_cast<float>(value));
        case Precision::half:
            return append(bytes, Imath::half(static_cast<float>(value)).bits());
        case Precision::unorm16:
            return append(bytes, static_cast<std::uint16_t>(value));
        case Precision::unorm8:
            return append(bytes, static_cast<std::uint8_t>(value));
    }
}

std::size_t StoredArray::groupColumns() const {
    constexpr std::size_t wanted = 16;
    return std::clamp<std::size_t>((wanted + rows() - 1) / std::max<std::size_t>(rows(), 1), 1,
                                   std::max<std::size_t>(columns(), 1));
}

std::size_t StoredArray::groups() const {
    return (columns() + groupColumns() - 1) / groupColumns();
}

void quantise(StoredArray& array, Precision precision, std::string_view name) {
    const Row& row = rowOf(precision);
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        if (std::isfinite(array.values[i]) && std::abs(array.values[i]) <= row.largest) continue;
        throw NumericError(
            fmt::format("{}: value {} is {}, beyond {}", name, i, array.values[i], row.name));
    }
    array.precision = precision;
    array.scales.clear();
    array.offsets.clear();
    if (row.steps > 0) spanGroups(array);
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        double& value = array.values[i];
        if (!isKept(array, i)) {
            value = 0;
        } else if (row.steps > 0) {
            value = valueOf(array, i, integerOf(array, i, row.steps), row.steps);
        } else if (precision == Precision::half) {
            value = static_cast<double>(static_cast<float>(Imath::half(static_cast<float>(value))));
        } else if (precision == Precision::float32) {
            value = static_cast<double>(static_cast<float>(value));
        }
    }
}

void keepLargest(StoredArray& array, std::size_t count, std::span<const double> weights) {
    if (count >= array.values.size()) return;
    std::vector<std::size_t> order(array.values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto size = [&](std::size_t i) {
        return std::abs(array.values[i]) * (weights.empty() ? 1 : weights[i]);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    array.kept.assign(array.values.size(), false);
    for (std::size_t k = 0; k < count; ++k) array.kept[order[k]] = true;
    for (std::size_t k = count; k < order.size(); ++k) array.values[order[k]] = 0;
}

std::vector<std::byte> packed(const StoredArray& array) {
    std::vector<std::byte> bytes;
    bytes.reserve(storedBytes(array));
    for (float scale : array.scales) append(bytes, scale);
    for (float offset : array.offsets) append(bytes, offset);
    for (std::size_t i = 0; i < array.kept.size(); i += 8) {
        unsigned bits = 0;
        for (std::size_t b = 0; b < 8 && i + b < array.kept.size(); ++b) {
            bits |= static_cast<unsigned>(array.kept[i + b]) << b;
        }
        append(bytes, static_cast<std::uint8_t>(bits));
    }
    const double steps = largestInteger(array.precision);
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        if (!isKept(array, i)) continue;
        appendNumber(bytes, array.precision,
                     steps > 0 ? integerOf(array, i, steps) : array.values[i]);
    }
    return bytes;
}

std::size_t storedBytes(const StoredArray& array) {
    return overhead(array) + keptCount(array) * numberBytes(array.precision);
}

std::size_t entropyBytes(const StoredArray& array) {
    const std::vector<std::byte> bytes = packed(array);
    std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
    const std::size_t length =
        ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_maxCLevel());
    if (ZSTD_isError(length)) throw NumericError("Zstandard cannot compress the array");
    return length;
}

void unpackInto(StoredArray& array, std::span<const std::byte> bytes, bool masked,
                const std::string& where) {
    const Row& row = rowOf(array.precision);
    // The bytes of the smallest file of this shape: nothing is allocated for more than there is.
    const std::size_t room = bytes.size() * (masked ? 8 : 1);
    const auto product = array.shape.empty() ? 0 : checkedProduct(array.shape);
    if (!product || *product > room) {
        throw InputError(
            fmt::format("{}: {} bytes cannot hold an array of this shape", where, bytes.size()));
    }
    const std::size_t count = *product;
    array.values.assign(count, 0);
    if (masked) array.kept.assign(count, false);
    const std::size_t head = overhead(array);
    const auto requireLength = [&](std::size_t length) {
        if (bytes.size() == length) return;
        throw InputError(
            fmt::format("{}: has {} bytes; its shape needs {}", where, bytes.size(), length));
    };
    if (bytes.size() < head) requireLength(head);
    ByteCursor cursor(bytes);
    if (row.steps > 0) {
        array.scales.resize(array.groups());
        array.offsets.resize(array.groups());
        for (float& scale : array.scales) scale = *cursor.number<float>();
        for (float& offset : array.offsets) offset = *cursor.number<float>();
    }
    for (std::size_t i = 0; masked && i < count; i += 8) {
        const unsigned bits = *cursor.number<std::uint8_t>();
        for (std::size_t b = 0; b < 8 && i + b < count; ++b) array.kept[i + b] = bits >> b & 1;
    }
    requireLength(head + keptCount(array) * row.bytes);
    for (std::size_t i = 0; i < count; ++i) {
        if (!isKept(array, i)) continue;
        const double number = takeNumber(cursor, array.precision);
        array.values[i] = row.steps > 0 ? valueOf(array, i, number, row.steps) : number;
        if (!std::isfinite(array.values[i])) {
            throw InputError(fmt::format("{}: value {} is not finite", where, i));
        }
    }
}

}  // namespace hshfit::inline representation
