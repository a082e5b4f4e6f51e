#include "map_texture.h"

#include <jobs/common/clock.h>
#include "map_processes.h"

#include <hshfit/pictures/rgb_picture.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {

MapWritten writeTexture(TexelSource& texels, TexelEncoder& encoder, const SvbrdfOptions& options,
                        const std::string& path, Svbrdf& result, const Listener& listener) {
    LevelFile texture(
        path, encoder.number(), encoder.layers(), result.levels,
        {.pairs = {{"hshfit:form", options.form}}, .pastPageCache = options.pastPageCache});
    const std::size_t texelBytes = texture.bytesOfTexel() + encoder.linear() + sizeof(float);
    const BandPlan plan =
        planBands(levelSizes(texels.width(), texels.height()), texelBytes, options.memory / 3);
    const auto start = Clock::now();
    MapWritten written = writeMap(texels, encoder, texture, plan, processesOfMaps(),
                                  {.progress = listener.part("texels")});
    result.seconds = secondsSince(start);
    result.rate = static_cast<double>(texels.width() * texels.height()) / result.seconds;
    result.errors = written.levels;
    result.errors.resize(result.levels.size());  // the others have none
    result.bytes = texture.bytes();
    result.pastPageCache = texture.isPastPageCache();
    return written;
}

std::string errorPicture(const MapWritten& written) {
    float largest = 0;
    for (const float error : written.pictureErrors) largest = std::max(largest, error);
    RgbPicture picture{static_cast<int>(written.picture.width),
                       static_cast<int>(written.picture.height)};
    for (const float error : written.pictureErrors) {
        const float shade =
            largest > 0 ? std::max(0.0F, 1 + std::log10(std::max(error / largest, 1e-3F)) / 3) : 0;
        picture.values.insert(picture.values.end(), 3, shade);
    }
    return rgbPng(picture, 0);
}

void sayTimeIsOver(const Svbrdf& result, const Listener& listener) {
    if (result.timeIsOver && processesOfMaps().isFirst())
        listener.say(
            fmt::format("{}: the map is whole, but the time was over before all errors were "
                        "measured",
                        result.folder));
}

}  // namespace hshfit::jobs
