// The bytes are a file with the tables of the Hosek-Wilkie sky. Tables that are read have all of
// their numbers, and the skies that they give are finite and not negative; what cannot be read is
// an error of one line.

#include <hshfit/error.h>
#include <hshfit/light/internal/hosek_wilkie_sky.h>
#include <hshfit/light/sky.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace {

void checkSky(const hshfit::HosekWilkieTables& tables, double turbidity, double albedo,
              const hshfit::Direction& sun) {
    using namespace hshfit;
    const SkyLight sky = hosekWilkieSky(tables, "input", turbidity, albedo, sun);
    for (const Direction& d : {sun, Direction{0, 0, 1}, {1, 0, 0}, {0, -0.6, 0.8}})
        for (const double value : radianceOf(sky, d))
            if (!(value >= 0 && std::isfinite(value))) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const HosekWilkieTables tables = hosekWilkieTablesIn(text, "input");
        for (const HosekWilkieChannel& channel : tables.channels)
            if (channel.shape.size() != 1080 || channel.radiance.size() != 120) std::abort();
        checkSky(tables, 1, 0, {1, 0, 0});
        checkSky(tables, 3.5, 0.3, {0, 0.6, 0.8});
        checkSky(tables, 10, 1, {0, 0, 1});
    } catch (const InputError& error) {
        if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
    }
    return 0;
}
