// The first byte picks side and part of the spectrum, the rest is a BSDF XML file.

#include <brdfs/measured/bsdf_xml/bsdf_xml.h>
#include <hshfit/error.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace {

void check(const hshfit::brdfs::MeasuredBrdf& brdf) {
    constexpr double x[] = {0, 0.6, -0.8, 0.28, 1, 0};
    constexpr double y[] = {0, 0, 0, -0.96, 0, 0.6};
    constexpr double z[] = {1, 0.8, 0.6, 1e-9, 0, -0.8};
    std::vector<double> out(6 * brdf.channels().count());
    std::vector<unsigned char> covered(6);
    for (const hshfit::Direction& wo :
         {hshfit::Direction{0, 0, 1}, {0.6, 0, 0.8}, {0, -1, 1e-12}}) {
        brdf.eval(wo, {x, y, z, 6}, out.data());
        for (const double f : out) {
            if (!(f >= 0) || !std::isfinite(f)) std::abort();
        }
        brdf.coverage(wo, {x, y, z, 6}, covered.data());
        brdf.kinks(wo);
    }
    brdf.facts();
    brdf.axes();
    brdf.census();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit::brdfs;
    if (size == 0) return 0;
    try {
        constexpr BsdfSide sides[] = {BsdfSide::front, BsdfSide::back, BsdfSide::transmissionFront,
                                      BsdfSide::transmissionBack};
        check(*openBsdfXml({data + 1, size - 1}, "input",
                           sides[(data[0] & 1) | ((data[0] >> 1) & 2)],
                           data[0] & 2 ? "solar" : "visible"));
    } catch (const hshfit::InputError&) {
    }
    return 0;
}
