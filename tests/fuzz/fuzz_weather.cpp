// The bytes are an EPW weather file. Hours that are read have finite irradiances at least 0 and a
// place on the Earth; what cannot be read is an error of one line.

#include <hshfit/error.h>
#include <hshfit/light/internal/weather_file.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const Moment& local : {Moment{2024, 6, 21, 12}, Moment{2001, 1, 1, 0}}) {
        try {
            const Weather weather = weatherIn(text, "input", local);
            for (const double value : {weather.direct, weather.diffuse})
                if (!(value >= 0 && value < 9999)) std::abort();
            if (!(std::abs(weather.place.latitude) <= 1.6)) std::abort();
            if (!(std::abs(weather.place.longitude) <= 3.2)) std::abort();
        } catch (const InputError& error) {
            if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
        }
    }
    return 0;
}
