#include <hshfit/light/picture_light.h>

#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

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

constexpr CurveName curves[] = {
    {TransferCurve::linear, "linear", "values are radiance"},
    {TransferCurve::srgb, "srgb", "IEC 61966-2-1"},
    {TransferCurve::rec709, "rec709", "the inverse of the camera curve of ITU-R BT.709"},
    {TransferCurve::gamma18, "gamma1.8", "value to the power of 1.8"},
    {TransferCurve::gamma22, "gamma2.2", "value to the power of 2.2"},
    {TransferCurve::gamma24, "gamma2.4", "value to the power of 2.4"},
};

struct Part {
    std::size_t column, row, width, height;
};

/// Cuts a picture into parts, from the pixels up: parts that need no cut become one sample.
class Parts {
public:
    Parts(const PictureLight& light, double finest)
        : light_(light), geometry_(geometryOf(light)), finest_(finest) {
        for (std::size_t row = 0; row < light.height; ++row) {
            for (std::size_t column = 0; column < light.width; ++column) {
                total_ += weigh(column, row).grey();
            }
        }
    }

    std::vector<PictureSample> samples() {
        add({0, 0, light_.width, light_.height});
        return std::move(samples_);
    }

private:
    struct Sum {
        Rgb flux{};
        double x = 0, y = 0, z = 0;  ///< of flux times direction
        double grey() const { return flux[0] + flux[1] + flux[2]; }
        void operator+=(const Sum& other) {
            for (std::size_t c = 0; c < 3; ++c) flux[c] += other.flux[c];
            x += other.x, y += other.y, z += other.z;
        }
    };

    /// Flux of one pixel, without its direction.
    Sum weigh(std::size_t column, std::size_t row) const {
        const float* rgb = light_.rgb.data() + 3 * (row * light_.width + column);
        if (rgb[0] + rgb[1] + rgb[2] <= 0) return {};
        const double omega = geometry_.solidAngle(column, row);
        return {{rgb[0] * omega, rgb[1] * omega, rgb[2] * omega}};
    }

    /// Adds the samples of a part and returns its sum.
    Sum add(const Part& part) {
        if (part.width * part.height == 0) return {};
        const std::size_t first = samples_.size();
        Sum sum;
        if (part.width * part.height == 1) {
            sum = weigh(part.column, part.row);
            const double grey = sum.grey();
            if (!(grey > 0)) return {};
            const Direction d = directionOf(light_, static_cast<double>(part.column) + 0.5,
                                            static_cast<double>(part.row) + 0.5);
            sum.x = grey * d.x, sum.y = grey * d.y, sum.z = grey * d.z;
        } else {
            const std::size_t w = (part.width + 1) / 2, h = (part.height + 1) / 2;
            sum += add({part.column, part.row, w, h});
            sum += add({part.column + w, part.row, part.width - w, h});
            sum += add({part.column, part.row + h, w, part.height - h});
            sum += add({part.column + w, part.row + h, part.width - w, part.height - h});
            const auto longest = static_cast<double>(std::max(part.width, part.height));
            if (sum.grey() * longest * geometry_.pixelAngle() > finest_ * total_) return sum;
        }
        samples_.resize(first);
        const double length = std::hypot(sum.x, sum.y, sum.z);
        if (length > 0) {
            samples_.push_back({{sum.x / length, sum.y / length, sum.z / length}, sum.flux});
        }
        return sum;
    }

    const PictureLight& light_;
    PictureGeometry geometry_;
    double finest_, total_ = 0;
    std::vector<PictureSample> samples_;
};

}  // namespace

std::span<const CurveName> curveNames() {
    return curves;
}

bool isPicturePath(std::string_view text) {
    std::error_code error;
    return std::filesystem::is_regular_file(text, error);
}

PictureLight readPictureLight(const std::string& path, double scale,
                              const PictureOptions& /*options*/) {
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

PictureGeometry geometryOf(const PictureLight& light) {
    return {light.layout, light.width, light.height};
}

PictureGeometry fileGeometryOf(const PictureLight& light) {
    if (light.fileWidth == 0) return geometryOf(light);
    return {light.layout, light.fileWidth, light.fileHeight};
}

void forEachRow(const PictureLight& light,
                const std::function<void(std::size_t row, std::span<const float> rgb)>& visit) {
    const std::span<const float> all(light.rgb);
    for (std::size_t row = 0; row < light.height; ++row) {
        visit(row, all.subspan(3 * light.width * row, 3 * light.width));
    }
}

Direction directionOf(const PictureLight& light, double column, double row) {
    return rotateAboutZ(geometryOf(light).direction(column, row), light.turn);
}

Rgb radianceOf(const PictureLight& light, const Direction& world) {
    const auto [column, row] = geometryOf(light).position(rotateAboutZ(world, -light.turn));
    const float* rgb = light.rgb.data() + 3 * (static_cast<std::size_t>(row) * light.width +
                                               static_cast<std::size_t>(column));
    return {rgb[0], rgb[1], rgb[2]};
}

std::vector<PictureSample> pictureSamples(const PictureLight& light, double finest) {
    return Parts(light, finest).samples();
}

}  // namespace hshfit::inline light
