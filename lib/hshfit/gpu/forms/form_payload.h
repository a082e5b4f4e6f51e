#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/representation/representation.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu::inline forms {

/// A number of the stream: a value of one of namedArrays(), or nothing, where a texel is filled up.
struct StreamNumber {
    static constexpr std::uint32_t nothing = 0xffffffff;

    std::uint32_t array = nothing, value = 0;
};

/// A coefficient file of any form but `outgoing` as a GPU reads it: its stored numbers one after
/// another in the order in which its shader needs them, four to a texel, in rows of `formWidth`.
/// Numbers that a mask leaves out are not there.
struct FormPayload {
    Representation form;  ///< as rounded: what shaders and files give
    std::vector<StreamNumber> stream;
    Texels texels;  ///< one layer; normalised numbers have scale 1 and offset 0
    /// f of the BRDF that the form adds, per channel, where it is the same for all directions; what
    /// the shader adds to the form. Empty: nothing is added.
    std::vector<double> constant = {};

    /// The factor and the addend that make of a number's texel its value.
    LaneScale scaleOf(const StreamNumber& number) const;
    /// The value of the form, 0 for nothing.
    double valueOf(const StreamNumber& number) const;
    std::size_t texelCount() const { return (stream.size() + 3) / 4; }
};
constexpr int formWidth = 64;

/// The number type of fewest bytes that holds every array as it is stored: float16 holds half and
/// unorm8 (as whole numbers), unorm16 and unorm8 themselves and what is coarser, float32 all but
/// float64, which it rounds.
Number numberFor(const Representation& form);

/// Arrays that `number` does not hold are rounded to it, which `form.steps` records. Throws
/// UsageError for the form `outgoing` (payload.h has that), InputError where the arrays do not
/// belong together, NumericError for a value beyond the range of the number type.
FormPayload packForm(Representation form, std::optional<Number> number = std::nullopt);

/// The inverse: `skeleton` has everything but the numbers, which are in `texels`. Throws InputError
/// that starts with `file` where a texel is no number of its array or the counts differ.
FormPayload unpackForm(Representation skeleton, Texels texels, const std::string& file);

}  // namespace hshfit::gpu::inline forms
