#include <hshfit/gpu/forms/form_payload.h>

#include <hshfit/byte_cursor.h>
#include <hshfit/error.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/representation/change.h>
#include <hshfit/representation/named_arrays.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::gpu::inline forms {
namespace {

/// The number types from the fewest bytes on; what each holds without rounding, and what it rounds
/// the rest to.
struct Holding {
    Number number;
    std::vector<Precision> holds;
    Precision rounds;
};
const std::array<Holding, 4>& holdings() {
    using enum Precision;
    static const std::array<Holding, 4> rows{{
        {Number::unorm8, {unorm8}, unorm8},
        {Number::float16, {half, unorm8}, half},
        {Number::unorm16, {unorm16, unorm8}, unorm16},
        {Number::float32, {float32, half, unorm16, unorm8}, float32},
    }};
    return rows;
}
const Holding& holdingOf(Number number) {
    return *std::ranges::find(holdings(), number, &Holding::number);
}
/// The precision of which a texel is a stored number.
Precision precisionOf(Number number) {
    return holdingOf(number).rounds;
}
bool holds(const Holding& row, Precision precision) {
    return std::ranges::find(row.holds, precision) != row.holds.end();
}

/// Every value's place among the values that are kept.
std::vector<std::size_t> ranksOf(const StoredArray& array) {
    std::vector<std::size_t> ranks(array.values.size());
    std::size_t rank = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i) {
        ranks[i] = rank;
        rank += array.kept.empty() || array.kept[i] ? 1 : 0;
    }
    return ranks;
}
/// The bytes of `packed` before its numbers.
std::size_t headOf(const StoredArray& array) {
    return storedBytes(array) - keptCount(array) * numberBytes(array.precision);
}

/// The factor between a stored number and its texel: 257 for 8 bits in 16.
double widening(Precision precision, Number number) {
    const double steps = largestInteger(precisionOf(number));
    return steps > 0 ? steps / largestInteger(precision) : 1;
}

Texels emptyTexels(Number number, std::size_t count) {
    const int texels = static_cast<int>(std::max<std::size_t>((count + 3) / 4, 1));
    Texels result;
    result.width = std::min(texels, formWidth);
    result.height = (texels + result.width - 1) / result.width;
    result.layers = 1;
    result.number = number;
    if (isNormalised(number)) result.scales.assign(4, {});
    return result;
}

/// Raw numbers of every array.
std::vector<std::vector<double>> storedNumbers(const Representation& form) {
    std::vector<std::vector<double>> all;
    for (const auto& each : namedArrays(form)) {
        const std::vector<std::byte> bytes = packed(*each.array);
        ByteCursor cursor(std::span<const std::byte>(bytes).subspan(headOf(*each.array)));
        std::vector<double>& numbers = all.emplace_back();
        for (std::size_t k = keptCount(*each.array); k > 0; --k)
            numbers.push_back(takeNumber(cursor, each.array->precision));
    }
    return all;
}

}  // namespace

LaneScale FormPayload::scaleOf(const StreamNumber& number) const {
    if (number.array == StreamNumber::nothing) return {};
    const StoredArray& array = *namedArrays(form)[number.array].array;
    const double steps = largestInteger(array.precision);
    if (steps == 0) return {};
    const std::size_t group = number.value % array.columns() / array.groupColumns();
    const double scale = static_cast<double>(array.scales[group]);
    return {isNormalised(texels.number) ? scale : scale / steps,
            static_cast<double>(array.offsets[group])};
}

double FormPayload::valueOf(const StreamNumber& number) const {
    if (number.array == StreamNumber::nothing) return 0;
    return namedArrays(form)[number.array].array->values[number.value];
}

Number numberFor(const Representation& form) {
    for (const Holding& row : holdings()) {
        const auto arrays = namedArrays(form);
        if (std::ranges::all_of(arrays,
                                [&](const auto& a) { return holds(row, a.array->precision); }))
            return row.number;
    }
    return Number::float32;
}

FormPayload packForm(Representation form, std::optional<Number> wanted) {
    const FormRow& row = formRow(form.kind());
    const Holding& holding = holdingOf(wanted.value_or(numberFor(form)));
    const Representation before = form;
    bool rounded = false;
    for (const auto& each : namedArrays(form)) {
        if (holds(holding, each.array->precision)) continue;
        quantise(*each.array, holding.rounds, each.name);
        rounded = true;
    }
    if (rounded) addStep(form, before, std::string(precisionName(holding.rounds)));

    FormPayload payload{std::move(form), {}, {}};
    payload.stream = row.stream(payload.form);
    payload.texels = emptyTexels(holding.number, payload.stream.size());
    const auto numbers = storedNumbers(payload.form);
    const auto arrays = namedArrays(payload.form);
    std::vector<std::vector<std::size_t>> ranks;
    for (const auto& each : arrays) ranks.push_back(ranksOf(*each.array));
    for (const StreamNumber& place : payload.stream) {
        double value = 0;
        if (place.array != StreamNumber::nothing) {
            value = numbers[place.array][ranks[place.array][place.value]] *
                    widening(arrays[place.array].array->precision, holding.number);
        }
        appendNumber(payload.texels.bytes, holding.rounds, value);
    }
    payload.texels.bytes.resize(payload.texels.count() * gpu::numberBytes(holding.number));
    return payload;
}

FormPayload unpackForm(Representation skeleton, Texels texels, const std::string& file) {
    FormPayload payload{std::move(skeleton), {}, std::move(texels)};
    try {
        payload.stream = formRow(payload.form.kind()).stream(payload.form);
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", file, error.what()));
    }
    const Texels wanted = emptyTexels(payload.texels.number, payload.stream.size());
    if (wanted.width != payload.texels.width || wanted.height != payload.texels.height ||
        payload.texels.layers != 1) {
        throw InputError(
            fmt::format("{}: the form has {} numbers, which fill {} x {} texels, not "
                        "{} x {}",
                        file, payload.stream.size(), wanted.width, wanted.height,
                        payload.texels.width, payload.texels.height));
    }
    const auto arrays = namedArrays(payload.form);
    std::vector<std::vector<double>> numbers;
    std::vector<std::vector<std::size_t>> ranks;
    for (const auto& each : arrays) {
        numbers.emplace_back(keptCount(*each.array), 0.0);
        ranks.push_back(ranksOf(*each.array));
    }
    ByteCursor cursor(std::span<const std::byte>(payload.texels.bytes));
    for (const StreamNumber& place : payload.stream) {
        const double texel = takeNumber(cursor, precisionOf(payload.texels.number));
        if (place.array == StreamNumber::nothing) continue;
        const Precision precision = arrays[place.array].array->precision;
        const double value = texel / widening(precision, payload.texels.number);
        const double steps = largestInteger(precision);
        if (!std::isfinite(value) ||
            (steps > 0 && (value < 0 || value > steps || value != std::floor(value)))) {
            throw InputError(fmt::format("{}: {} is no {} number of the array '{}'", file, texel,
                                         precisionName(precision), arrays[place.array].name));
        }
        numbers[place.array][ranks[place.array][place.value]] = value;
    }
    for (std::size_t a = 0; a < arrays.size(); ++a) {
        StoredArray& array = *namedArrays(payload.form)[a].array;
        std::vector<std::byte> bytes = packed(array);
        bytes.resize(headOf(array));
        for (const double value : numbers[a]) appendNumber(bytes, array.precision, value);
        unpackInto(array, bytes, !array.kept.empty(), file);
    }
    return payload;
}

}  // namespace hshfit::gpu::inline forms
