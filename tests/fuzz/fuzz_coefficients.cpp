// The bytes are a coefficient file: EXR if they start with its magic number, else JSON, in plain
// coefficients or another form. A file that reads is also written and read again, and has to be the
// same; forms are evaluated besides.

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/printable.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/named_arrays.h>

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

void check(const hshfit::Representation& r) {
    const auto again = hshfit::representationFromJson(hshfit::representationToJson(r), "again");
    const auto before = hshfit::namedArrays(r), after = hshfit::namedArrays(again);
    if (after.size() != before.size() || again.bytes() != r.bytes()) std::abort();
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (after[i].name != before[i].name) std::abort();
        if (after[i].array->values != before[i].array->values) std::abort();
    }
    const auto brdf = hshfit::reconstruct(r, [](const std::string& spec) {
        throw hshfit::InputError("no models here: " + hshfit::printable(spec));
        return std::unique_ptr<hshfit::Brdf>();
    });
    hshfit::evaluate(*brdf, {0.6, 0, 0.8}, {0, 0.6, 0.8});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    hshfit::exrSaysCoefficients(bytes);
    try {
        if (hshfit::hasRepresentation(bytes)) {
            check(hshfit::representationFromJson(bytes, "input"));
            return 0;
        }
        check(hshfit::hasExrMagic(bytes) ? hshfit::coefficientsFromExr(bytes, "input")
                                         : hshfit::coefficientsFromJson(bytes, "input"));
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
