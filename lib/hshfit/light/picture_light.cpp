#include <hshfit/light/picture_light.h>

#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr std::size_t mostValues = std::size_t{1} << 28;

std::size_t channelOf(const ExrPicture& picture, std::string_view name, const std::string& path) {
    for (std::string_view wanted : {name, std::string_view("Y")}) {
        const auto at = std::find(picture.channels.begin(), picture.channels.end(), wanted);
        if (at != picture.channels.end()) {
            return static_cast<std::size_t>(at - picture.channels.begin());
        }
    }
    throw InputError(
        fmt::format("{}: has no channel {}; an environment has R, G and B", path, name));
}

double polar(const PictureLight& light, double row) {
    return pi * row / static_cast<double>(light.height);
}

/// Solid angle of one pixel of a row.
double pixelSolidAngle(const PictureLight& light, std::size_t row) {
    const double top = polar(light, static_cast<double>(row));
    const double bottom = polar(light, static_cast<double>(row + 1));
    const double step = 2 * pi / static_cast<double>(light.width);
    return 2 * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2) * step;
}

struct Part {
    std::size_t column, row, width, height;
};

/// Sums of flux and of flux times direction over any part, from tables of running sums.
class Sums {
public:
    explicit Sums(const PictureLight& light) : width_(light.width + 1) {
        table_.resize(width_ * (light.height + 1));
        for (std::size_t row = 0; row < light.height; ++row) {
            const double solidAngle = pixelSolidAngle(light, row);
            for (std::size_t column = 0; column < light.width; ++column) {
                const Direction d = directionOf(light, static_cast<double>(column) + 0.5,
                                                static_cast<double>(row) + 0.5);
                const float* rgb = light.rgb.data() + 3 * (row * light.width + column);
                const double all = (double{rgb[0]} + rgb[1] + rgb[2]) * solidAngle;
                const Entry here{rgb[0] * solidAngle, rgb[1] * solidAngle, rgb[2] * solidAngle,
                                 all * d.x,           all * d.y,           all * d.z};
                for (std::size_t k = 0; k < here.size(); ++k) {
                    at(column + 1, row + 1)[k] = here[k] + at(column, row + 1)[k] +
                                                 at(column + 1, row)[k] - at(column, row)[k];
                }
            }
        }
    }
    using Entry = std::array<double, 6>;
    Entry over(const Part& p) const {
        Entry sum{};
        for (std::size_t k = 0; k < sum.size(); ++k) {
            sum[k] = at(p.column + p.width, p.row + p.height)[k] + at(p.column, p.row)[k] -
                     at(p.column, p.row + p.height)[k] - at(p.column + p.width, p.row)[k];
        }
        return sum;
    }

private:
    Entry& at(std::size_t column, std::size_t row) { return table_[row * width_ + column]; }
    const Entry& at(std::size_t column, std::size_t row) const {
        return table_[row * width_ + column];
    }
    std::size_t width_;
    std::vector<Entry> table_;
};

}  // namespace

PictureLight readPictureLight(const std::string& path, double scale) {
    const MappedFile file(path);
    const ExrPicture picture =
        readExrPicture({reinterpret_cast<const char*>(file.data()), file.size()}, path, mostValues);
    if (picture.width != 2 * picture.height) {
        throw InputError(
            fmt::format("{}: is {} x {} pixels; a latitude-longitude picture is twice "
                        "as wide as high",
                        path, picture.width, picture.height));
    }
    const std::size_t channels[] = {channelOf(picture, "R", path), channelOf(picture, "G", path),
                                    channelOf(picture, "B", path)};
    PictureLight light{.file = path, .width = picture.width, .height = picture.height, .rgb = {}};
    light.rgb.reserve(3 * picture.width * picture.height);
    for (std::size_t row = 0; row < picture.height; ++row) {
        for (std::size_t column = 0; column < picture.width; ++column) {
            for (std::size_t channel : channels) {
                const float value = picture.at(row, column, channel);
                if (!(value >= 0 && std::isfinite(value))) {
                    throw InputError(fmt::format(
                        "{}: radiance {} at column {}, row {}; it has to be finite and not below 0",
                        path, value, column, row));
                }
                light.rgb.push_back(static_cast<float>(value * scale));
            }
        }
    }
    file.checkIntact();
    return light;
}

Direction directionOf(const PictureLight& light, double column, double row) {
    return directionFromAngles(
        polar(light, row), pi - 2 * pi * column / static_cast<double>(light.width) + light.turn);
}

Rgb radianceOf(const PictureLight& light, const Direction& world) {
    const double around = std::remainder(pi - azimuth(world) + light.turn - pi, 2 * pi) + pi;
    const auto index = [](double at, std::size_t count) {
        return static_cast<std::size_t>(std::clamp(std::floor(at * static_cast<double>(count)), 0.0,
                                                   static_cast<double>(count) - 1));
    };
    const std::size_t row = index(polarAngle(world) / pi, light.height);
    const std::size_t column = index(around / (2 * pi), light.width);
    const float* rgb = light.rgb.data() + 3 * (row * light.width + column);
    return {rgb[0], rgb[1], rgb[2]};
}

std::vector<PictureSample> pictureSamples(const PictureLight& light, double finest) {
    const Sums sums(light);
    const auto flux = [&](const Part& part) {
        const Sums::Entry sum = sums.over(part);
        return sum[0] + sum[1] + sum[2];
    };
    const double total = flux({0, 0, light.width, light.height});
    const double pixel = pi / static_cast<double>(light.height);
    std::vector<PictureSample> samples;
    std::vector<Part> parts{{0, 0, light.width, light.height}};
    while (!parts.empty()) {
        const Part part = parts.back();
        parts.pop_back();
        const double wide = pixel * static_cast<double>(std::max(part.width, part.height));
        const double share = total > 0 ? flux(part) / total : 0;
        if (part.width * part.height > 1 && share * wide > finest) {
            const std::size_t w = (part.width + 1) / 2, h = (part.height + 1) / 2;
            for (std::size_t row : {std::size_t{0}, h}) {
                for (std::size_t column : {std::size_t{0}, w}) {
                    const Part quarter{part.column + column, part.row + row,
                                       column == 0 ? w : part.width - w,
                                       row == 0 ? h : part.height - h};
                    if (quarter.width * quarter.height > 0) parts.push_back(quarter);
                }
            }
            continue;
        }
        const Sums::Entry sum = sums.over(part);
        const double length = std::hypot(sum[3], sum[4], sum[5]);
        if (!(length > 0)) continue;
        samples.push_back({{sum[3] / length, sum[4] / length, sum[5] / length},
                           {std::max(sum[0], 0.0), std::max(sum[1], 0.0), std::max(sum[2], 0.0)}});
    }
    return samples;
}

}  // namespace hshfit::inline light
