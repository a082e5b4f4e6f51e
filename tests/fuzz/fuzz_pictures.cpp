// The first byte chooses a layout and a curve, the rest is a picture file. A picture that is read
// has radiance that is finite and not negative, in every direction and every part.

#include <hshfit/error.h>
#include <hshfit/light/picture_light.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

namespace {

using namespace hshfit;

void check(const PictureLight& light) {
    for (const Direction& d : {Direction{0, 0, 1},
                               {0, 0, -1},
                               {1, 0, 0},
                               {-1, 0, 0},
                               {0, 0.6, -0.8},
                               {0.48, -0.6, 0.64}})
        for (const double value : radianceOf(light, d))
            if (!(value >= 0) || !std::isfinite(value)) std::abort();
    for (const PictureSample& part : pictureSamples(light, 1e-2))
        for (const double value : part.flux)
            if (!(value >= 0)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    const int file = memfd_create("picture", 0);
    if (file < 0 || write(file, data + 1, size - 1) != static_cast<ssize_t>(size - 1)) std::abort();
    const std::string path = "/proc/self/fd/" + std::to_string(file);
    PictureOptions options;
    const auto layouts = layoutNames();
    const auto curves = curveNames();
    if (const std::size_t k = data[0] % 8; k < layouts.size()) options.layout = layouts[k].layout;
    if (const std::size_t k = data[0] / 8 % 8; k < curves.size()) options.curve = curves[k].curve;
    try {
        const PictureReader header(path, options);
        const PictureGeometry& g = header.facts().geometry;
        // Large ones are slow and bring nothing new.
        if (g.width * g.height <= 1 << 16) check(readPictureLight(path, 1, options));
    } catch (const InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    close(file);
    return 0;
}
