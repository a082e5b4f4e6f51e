// Either a UTIA picture (the bytes are an EXR file), or a script that makes a UTIA table, which is
// too large to be mutated: an octet for the options, a f64 for all values, then patches of 12
// bytes: u32 index, f64 value. Octets from 250 cut the table short.

#include <brdfs/measured/gridded/utia.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>

#include <fuzz/gridded_checks.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace {

using hshfit::brdfs::UtiaBrdf;
using hshfit::brdfs::UtiaOptions;

double number(const std::uint8_t* at) {
    double value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

void read(std::span<const unsigned char> bytes, std::uint8_t choice) {
    const UtiaOptions options{
        .beyond = choice % 2 ? UtiaOptions::Beyond::constant : UtiaOptions::Beyond::linear,
        .colours = static_cast<UtiaOptions::Colours>(choice / 2 % 3),
        .scale = choice % 5 == 0 ? 1 : 1e12};
    try {
        hshfit::fuzz::check(UtiaBrdf(bytes, "input", options));
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (hshfit::hasExrMagic({reinterpret_cast<const char*>(data), size})) {
        read({data, size}, static_cast<std::uint8_t>(size));
        return 0;
    }
    if (size < 9) return 0;
    std::vector<double> values(UtiaBrdf::values, number(data + 1));
    for (std::size_t at = 9; at + 12 <= size; at += 12) {
        std::uint32_t index;
        std::memcpy(&index, data + at, sizeof index);
        values[index % values.size()] = number(data + at + 4);
    }
    const std::size_t bytes = UtiaBrdf::fileBytes - (data[0] >= 250 ? data[0] - 249u : 0u);
    read({reinterpret_cast<const unsigned char*>(values.data()), bytes}, data[0]);
    return 0;
}
