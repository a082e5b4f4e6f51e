// The bytes are a coefficient file: EXR if they start with its magic number, else JSON. What reads
// is also written and read again, and has to be the same.

#include <hshfit/error.h>
#include <hshfit/output/coefficient_formats.h>
#include <hshfit/output/exr_header.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

void check(const hshfit::Coefficients& c) {
    if (c.values.size() != c.outgoing.size() * c.channels.count() * c.slots()) std::abort();
    const auto again = hshfit::coefficientsFromJson(hshfit::coefficientsToJson(c), "again");
    if (again.values != c.values || again.channels.names() != c.channels.names() ||
        again.outgoing.spec() != c.outgoing.spec() || again.source != c.source) {
        std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    hshfit::exrSaysCoefficients(bytes);
    try {
        check(hshfit::hasExrMagic(bytes) ? hshfit::coefficientsFromExr(bytes, "input")
                                         : hshfit::coefficientsFromJson(bytes, "input"));
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
