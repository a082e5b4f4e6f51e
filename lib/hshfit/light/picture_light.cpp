#include <hshfit/light/picture_light.h>

#include <hshfit/error.h>
#include <hshfit/light/internal/picture_filling.h>
#include <hshfit/light/internal/picture_reduction.h>
#include <hshfit/light/internal/picture_seams.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline light {
namespace {

/// Radiance from the values of a row, with pixels that are none as 0, or replaced, counted.
class Scaling {
public:
    Scaling(const PictureGeometry& geometry, double scale, bool clamped = false,
            const FilledPixels* filled = nullptr)
        : geometry_(geometry), scale_(scale), clamped_(clamped), filled_(filled) {}

    void apply(std::size_t row, std::span<const float> from, std::span<float> to) {
        for (std::size_t column = 0; column < geometry_.width; ++column) {
            const float* value = from.data() + 3 * column;
            float* out = to.data() + 3 * column;
            bool valid = true;
            for (std::size_t c = 0; c < 3; ++c) {
                out[c] = static_cast<float>(value[c] * scale_);
                valid &= out[c] >= 0 && out[c] <= std::numeric_limits<float>::max();
            }
            if (valid) continue;
            const FilledPixel* fill = filled_ ? pixelAt(*filled_, row, column) : nullptr;
            if (fill)
                std::ranges::transform(fill->rgb, out,
                                       [&](float v) { return static_cast<float>(v * scale_); });
            else if (clamped_)
                std::transform(value, value + 3, out, [&](float v) { return clamped(v); });
            else
                std::fill(out, out + 3, 0.F);
            if (geometry_.solidAngle(column, row) > 0) count(column, row, value);
        }
    }

    const PictureCensus& census() const { return census_; }

    /// `converted`: from other primaries, which may have made values negative.
    void requireNone(const std::string& path, bool converted = false) const {
        if (census_.total() == 0) return;
        throw InputError(fmt::format(
            "{}: {} pixels below 0, {} infinite, {} not a number; the first is {} at column {}, "
            "row {}; radiance has to be finite and not below 0{}; invalid=clamp goes on, and "
            "invalid=inpaint with what is around them",
            path, census_.negative, census_.infinite, census_.notANumber, firstValue_, firstColumn_,
            firstRow_,
            converted ? " (colours of the file's primaries may lie outside of Rec. 709)" : ""));
    }

private:
    float clamped(float value) const {
        constexpr float largestHalf = 65504;
        const auto scaled = static_cast<float>(value * scale_);
        if (!(scaled > 0)) return 0;
        return std::isfinite(scaled) ? scaled : largestHalf;
    }

    void count(std::size_t column, std::size_t row, const float* value) {
        const float* worst = std::find_if(value, value + 3, [&](float v) {
            return !(v >= 0 && std::isfinite(static_cast<float>(v * scale_)));
        });
        if (census_.total() == 0) firstValue_ = *worst, firstColumn_ = column, firstRow_ = row;
        if (std::any_of(value, value + 3, [](float v) { return std::isnan(v); })) {
            ++census_.notANumber;
        } else if (*worst < 0) {
            ++census_.negative;
        } else {
            ++census_.infinite;
        }
    }

    PictureGeometry geometry_;
    double scale_;
    bool clamped_;
    const FilledPixels* filled_;
    PictureCensus census_;
    float firstValue_ = 0;
    std::size_t firstColumn_ = 0, firstRow_ = 0;
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
        // Neighbours in a picture of faces may be far apart in direction.
        const std::size_t face = geometry_.faceSize();
        const std::size_t width = face > 0 ? face : light_.width;
        const std::size_t height = face > 0 ? face : light_.height;
        for (std::size_t row = 0; row < light_.height; row += height) {
            for (std::size_t column = 0; column < light_.width; column += width) {
                add({column, row, width, height});
            }
        }
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

PictureLight readPictureLight(const std::string& path, double scale, const PictureOptions& options,
                              InvalidPixels invalid) {
    std::shared_ptr<const FilledPixels> filled;
    if (invalid == InvalidPixels::inpainted)
        filled = std::make_shared<const FilledPixels>(fillPixels(path, options));
    PictureReader reader(path, options);
    const PictureFacts& facts = reader.facts();
    const PictureGeometry& file = facts.geometry;
    PictureReduction reduction(file, mostHeldPixels);
    const bool clamped = invalid == InvalidPixels::clamped;
    Scaling scaling(file, scale, clamped, filled.get());
    std::vector<float> row(3 * file.width);
    reader.forEachRow([&](std::size_t at, std::span<const float> values) {
        scaling.apply(at, values, row);
        reduction.add(at, row);
    });
    // A scale may make more pixels infinite than were filled.
    if (invalid == InvalidPixels::refused || (filled && scaling.census().total() > filled->size()))
        scaling.requireNone(path, facts.colour.primaries.has_value());
    PictureLight light{.file = path,
                       .width = reduction.geometry().width,
                       .height = reduction.geometry().height,
                       .rgb = reduction.result(),
                       .layout = file.layout,
                       .curve = facts.curve,
                       .part = options.part,
                       .layer = options.layer,
                       .clamped = clamped,
                       .scale = scale,
                       .census = scaling.census(),
                       .fileLayout = facts.layout,
                       .filled = filled};
    if (light.width != file.width) light.fileWidth = file.width, light.fileHeight = file.height;
    light.remark = seamRemark(light);
    return light;
}

std::vector<std::string> remarksOf(std::span<const Light> lights) {
    std::vector<std::string> remarks;
    for (const Light& light : lights) {
        const auto* picture = std::get_if<PictureLight>(&light);
        if (picture && !picture->remark.empty()) remarks.push_back(picture->remark);
    }
    return remarks;
}

PictureGeometry geometryOf(const PictureLight& light) {
    return {light.layout, light.width, light.height};
}

PictureGeometry fileGeometryOf(const PictureLight& light) {
    if (light.fileWidth == 0) return geometryOf(light);
    return {light.layout, light.fileWidth, light.fileHeight};
}

PictureOptions optionsOf(const PictureLight& light) {
    return {
        .layout = light.fileLayout, .curve = light.curve, .part = light.part, .layer = light.layer};
}

void forEachRow(const PictureLight& light, const RowVisitor& visit) {
    if (light.fileWidth == 0) {
        const std::span<const float> all(light.rgb);
        for (std::size_t row = 0; row < light.height; ++row) {
            visit(row, all.subspan(3 * light.width * row, 3 * light.width));
        }
        return;
    }
    PictureReader reader(light.file, optionsOf(light));
    const PictureGeometry file = reader.facts().geometry;
    if (file.width != light.fileWidth || file.height != light.fileHeight) {
        throw InputError(fmt::format("{}: changed while it was in use", light.file));
    }
    Scaling scaling(file, light.scale, light.clamped, light.filled.get());
    std::vector<float> scaled(3 * file.width);
    reader.forEachRow([&](std::size_t row, std::span<const float> values) {
        scaling.apply(row, values, scaled);
        visit(row, scaled);
    });
    if (light.census.total() == 0) scaling.requireNone(light.file);
}

Direction toWorld(const PictureLight& light, Direction d) {
    if (light.mirrored) d.y = -d.y;
    return rotateAboutZ(light.tilt(d), light.turn);
}

Direction toPicture(const PictureLight& light, const Direction& world) {
    Direction d = light.tilt.inverse()(rotateAboutZ(world, -light.turn));
    if (light.mirrored) d.y = -d.y;
    return d;
}

Direction directionOf(const PictureLight& light, double column, double row) {
    return toWorld(light, geometryOf(light).direction(column, row));
}

Rgb radianceOf(const PictureLight& light, const Direction& world) {
    const PictureGeometry geometry = geometryOf(light);
    const Direction d = toPicture(light, world);
    if (!geometry.covers(d)) return {};
    const auto [column, row] = geometry.position(d);
    const float* rgb = light.rgb.data() + 3 * (static_cast<std::size_t>(row) * light.width +
                                               static_cast<std::size_t>(column));
    return {rgb[0], rgb[1], rgb[2]};
}

std::vector<PictureSample> pictureSamples(const PictureLight& light, double finest) {
    return Parts(light, finest).samples();
}

}  // namespace hshfit::inline light
