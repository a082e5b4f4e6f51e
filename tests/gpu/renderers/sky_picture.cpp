// sky_picture SPEC WIDTH FILE: the radiance of a light as a latitude-longitude PFM picture, WIDTH
// pixels by half as many, for blender_sky.py.

#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>

#include <charconv>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <string_view>

int main(int count, char** arguments) try {
    using namespace hshfit;
    if (count != 4) return 2;
    const std::vector<Light> lights = parseLights(arguments[1]).lights;
    const std::string_view text(arguments[2]);
    std::size_t width = 0;
    std::from_chars(text.data(), text.data() + text.size(), width);
    const std::size_t height = width / 2;
    std::ofstream out(arguments[3], std::ios::binary);
    out << "PF\n" << width << ' ' << height << "\n-1.0\n";
    // PFM begins at the bottom.
    for (std::size_t row = height; row-- > 0;) {
        const double theta = pi * (static_cast<double>(row) + 0.5) / static_cast<double>(height);
        for (std::size_t column = 0; column < width; ++column) {
            const double across = (static_cast<double>(column) + 0.5) / static_cast<double>(width);
            for (const double value :
                 radianceFrom(lights, directionFromAngles(theta, pi * (1 - 2 * across)))) {
                const auto single = static_cast<float>(value);
                out.write(reinterpret_cast<const char*>(&single), sizeof single);
            }
        }
    }
    return out.flush() ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
}
