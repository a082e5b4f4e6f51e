// The bytes are an RGL file.

#include <brdfs/measured/rgl.h>
#include <hshfit/error.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace {

void check(const hshfit::brdfs::RglBrdf& brdf) {
    constexpr double x[] = {0, 0.6, -0.8, 0.28, 1, 0};
    constexpr double y[] = {0, 0, 0, -0.96, 0, 0.6};
    constexpr double z[] = {1, 0.8, 0.6, 1e-9, 0, -0.8};
    const std::size_t channels = brdf.channels().count();
    if (channels > 4096) return;  // only slow
    std::vector<double> out(6 * channels);
    for (const hshfit::Direction& wo :
         {hshfit::Direction{0, 0, 1}, {0.6, 0, 0.8}, {0, -1, 1e-12}}) {
        brdf.eval(wo, {x, y, z, 6}, out.data());
        for (const double f : out) {
            if (!(f >= 0) || !std::isfinite(f)) std::abort();
        }
        brdf.lobes(wo);
    }
    unsigned char covered[6];
    brdf.coverage({0.6, 0, 0.8}, {x, y, z, 6}, covered);
    const auto census = brdf.census();
    if (census.belowHorizon > census.values) std::abort();
    brdf.axes();
    brdf.facts();
    brdf.channels().names();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        check(hshfit::brdfs::RglBrdf({data, size}, "input"));
    } catch (const hshfit::InputError&) {
    }
    return 0;
}
