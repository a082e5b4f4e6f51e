#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit {
class ByteCursor;
}

namespace hshfit::inline representation {

/// The number type of a stored array; little-endian.
enum class Precision {
    float64,
    float32,
    half,     ///< IEEE binary16, nearest even; up to 65504
    unorm16,  ///< integer / 65535, times a scale plus an offset for each group of columns
    unorm8,   ///< integer / 255, likewise
};
std::string_view precisionName(Precision precision);  ///< "float32", as in files and options
/// Throws UsageError with the five names.
Precision parsePrecision(std::string_view name);
std::size_t numberBytes(Precision precision);

/// An array as a file keeps it. `values` are what the stored numbers decode to, so that whatever is
/// computed from them holds for the file.
struct StoredArray {
    std::vector<std::size_t> shape;  ///< row-major; the last axis counts columns
    Precision precision = Precision::float64;
    std::vector<double> values;
    /// unorm: value = offset + scale * integer / (largest integer), float32 each, for each group of
    /// `groupColumns` consecutive columns.
    std::vector<float> scales = {}, offsets = {};
    /// One flag per value, row-major, where only some are stored and the others are 0; empty: all.
    std::vector<bool> kept = {};

    std::size_t columns() const { return shape.empty() ? 0 : shape.back(); }
    std::size_t rows() const { return columns() == 0 ? 0 : values.size() / columns(); }
    /// 1, or as many as make 16 numbers where there are fewer rows than that: scales are then a
    /// small part of what is stored.
    std::size_t groupColumns() const;
    std::size_t groups() const;
};

/// Rounds the values to what `precision` holds. The scale of a group spans its kept values.
/// Throws NumericError, with the array's `name`, for a value that is not finite or beyond the range
/// of the number type.
void quantise(StoredArray& array, Precision precision, std::string_view name = "array");

/// Keeps the `count` values that are largest in `weights` times magnitude, of equal ones the first,
/// and sets the others to 0. `weights`: one per value, or empty for 1. Call before `quantise`.
void keepLargest(StoredArray& array, std::size_t count, std::span<const double> weights = {});

/// Scales and offsets, then the mask (one bit per value, the lowest first), then the numbers that
/// are kept: all that a reader needs besides shape and precision.
std::vector<std::byte> packed(const StoredArray& array);
/// Length of `packed` without making it.
std::size_t storedBytes(const StoredArray& array);
/// Length of `packed` after Zstandard at its highest level: what entropy coding leaves.
std::size_t entropyBytes(const StoredArray& array);

/// The values from `packed`. `array` has shape, precision and, in `masked`, whether there is
/// a mask. Throws InputError that starts with `where` if the length or a number is wrong.
void unpackInto(StoredArray& array, std::span<const std::byte> bytes, bool masked,
                const std::string& where);

/// For those who keep the numbers elsewhere than at the end of `packed`, such as in texels.
std::size_t keptCount(const StoredArray& array);  ///< how many there are
double largestInteger(Precision precision);       ///< of a normalised number; 0: floating point
/// A number as it is stored: a whole one for normalised types. The bytes have to be there.
double takeNumber(ByteCursor& cursor, Precision precision);
void appendNumber(std::vector<std::byte>& bytes, Precision precision, double value);

}  // namespace hshfit::inline representation
