// The bytes are a polarimetric table in a tensor file.

#include <brdfs/measured/pbsdf.h>
#include <fuzz/check_brdf.h>
#include <hshfit/error.h>

#include <cstdint>
#include <cstdlib>

namespace {

void check(const hshfit::brdfs::PbsdfBrdf& brdf) {
    hshfit::test::checkBrdf(brdf);
    const auto census = brdf.census();
    if (census.belowHorizon + census.invalid > census.values) std::abort();
    brdf.axes();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    for (const char* element : {"m00", "m12", "dolp", "all"}) try {
            check({{data, size}, "input", hshfit::brdfs::MuellerElements(element)});
        } catch (const hshfit::InputError&) {
        }
    return 0;
}
