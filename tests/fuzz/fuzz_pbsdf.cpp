// The bytes are a polarimetric table in a tensor file.

#include <brdfs/measured/pbsdf.h>
#include <hshfit/error.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace {

void check(const hshfit::brdfs::PbsdfBrdf& brdf) {
    constexpr double x[] = {0, 0.6, -0.8, 0.28, 1, 0};
    constexpr double y[] = {0, 0, 0, -0.96, 0, 0.6};
    constexpr double z[] = {1, 0.8, 0.6, 1e-9, 0, -0.8};
    const std::size_t channels = brdf.channels().count();
    std::vector<double> out(6 * channels);
    unsigned char covered[6];
    for (const hshfit::Direction& wo :
         {hshfit::Direction{0, 0, 1}, {0.6, 0, 0.8}, {0, -1, 1e-12}}) {
        brdf.eval(wo, {x, y, z, 6}, out.data());
        for (const double f : out) {
            if (!(f >= 0) || !std::isfinite(f)) std::abort();
        }
        brdf.coverage(wo, {x, y, z, 6}, covered);
        for (const unsigned char c : covered) {
            if (c > 1) std::abort();
        }
    }
    const auto census = brdf.census();
    if (census.belowHorizon + census.invalid > census.values) std::abort();
    brdf.axes();
    brdf.facts();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        check(hshfit::brdfs::PbsdfBrdf({data, size}, "input"));
    } catch (const hshfit::InputError&) {
    }
    return 0;
}
