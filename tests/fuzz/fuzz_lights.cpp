// The bytes are a light specification. Lights that parse have radiance that is finite and not
// negative; what does not parse is an error of one line.

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string text(reinterpret_cast<const char*>(data), size);
    try {
        const LightSpecification parsed = parseLights(text);
        for (const Direction& d : {Direction{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -0.6, 0.8}})
            for (const double value : radianceFrom(parsed.lights, d))
                if (!(value >= 0) || std::isnan(value)) std::abort();
        if (parsed.lights.size() < 3) sampleLights(parsed.lights, Frame({0.5, 1, 0}), 0);
    } catch (const Error& error) {
        if (error.code() != ExitCode::usage && error.code() != ExitCode::input) std::abort();
    }
    return 0;
}
