#include "parameter_maps.h"

#include <hshfit/error.h>
#include <hshfit/light/picture_reader.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {

/// One picture and its channels, with the rows that were read last.
class ParameterMaps::Map {
public:
    Map(const MapReference& reference, const Parameter& parameter)
        : reference_(reference), parameter_(parameter), picture_(reference.path) {
        const bool colour = parameter.kind == Parameter::Kind::colour;
        if (!reference.channels.empty()) {
            for (const std::string& name : reference.channels) indices_.push_back(find(name));
        } else if (colour && picture_.find("R") >= 0) {
            for (const char* name : {"R", "G", "B"}) indices_.push_back(find(name));
        } else {
            indices_.push_back(0);
        }
        first_ = *std::ranges::min_element(indices_);
        last_ = *std::ranges::max_element(indices_) + 1;
        if (!picture_.wholeNumbers() && reference.curve != TransferCurve::linear) {
            picture_.fail(fmt::format("its {} values are linear, not coded by {}",
                                      picture_.number(), curveName(reference.curve)));
        }
    }

    const PictureFile& picture() const { return picture_; }
    std::size_t channels() const { return indices_.size(); }

    /// out[channel][column]
    void row(std::size_t row, float* out) {
        const auto stride = static_cast<std::size_t>(last_ - first_);
        const std::size_t width = picture_.width();
        if (row < top_ || row >= bottom_) {
            const std::size_t rows = picture_.blockRows(stride);
            top_ = row / rows * rows;
            bottom_ = std::min(top_ + rows, picture_.height());
            block_.resize((bottom_ - top_) * width * stride);
            picture_.read(top_, bottom_, first_, last_, block_.data());
        }
        for (std::size_t c = 0; c < channels(); ++c) {
            const float* from = block_.data() + (row - top_) * width * stride +
                                static_cast<std::size_t>(indices_[c] - first_);
            for (std::size_t x = 0; x < width; ++x) out[c * width + x] = value(from[x * stride]);
        }
    }

    /// Reads all rows; the range of the values that occur.
    void check(double& low, double& high, const Listener& listener) {
        const auto progress = listener.part(fmt::format("checking {}", picture_.path()));
        const std::size_t width = picture_.width();
        std::vector<float> values(width * channels());
        for (std::size_t y = 0; y < picture_.height(); ++y) {
            row(y, values.data());
            for (std::size_t k = 0; k < values.size(); ++k) {
                const auto v = static_cast<double>(values[k]);
                // Bounds are compared in the precision of the values.
                if (!(values[k] >= static_cast<float>(parameter_.min) &&
                      values[k] <= static_cast<float>(parameter_.max))) {
                    picture_.fail(fmt::format("texel ({}, {}): {} is {:g}; valid: {}", k % width, y,
                                              parameter_.name, v, validValues(parameter_)));
                }
                low = std::min(low, v);
                high = std::max(high, v);
            }
            if (progress) progress(y + 1, picture_.height());
        }
    }

private:
    int find(const std::string& name) const {
        const int index = picture_.find(name);
        if (index < 0) {
            picture_.fail(fmt::format("has no channel {}; channels: {}", name,
                                      fmt::join(picture_.channels(), ", ")));
        }
        return index;
    }
    float value(float stored) const {
        double v = static_cast<double>(stored);
        if (reference_.curve != TransferCurve::linear) v = decoded(reference_.curve, v);
        if (reference_.power != 1) v = std::pow(v, reference_.power);
        return static_cast<float>(reference_.offset + reference_.scale * v);
    }

    MapReference reference_;
    const Parameter& parameter_;
    PictureFile picture_;
    std::vector<int> indices_;
    int first_ = 0, last_ = 0;
    std::size_t top_ = 0, bottom_ = 0;
    std::vector<float> block_;
};

ParameterMaps::ParameterMaps(const MaterialDescription& description, const Listener& listener) {
    const auto model = std::ranges::find(brdfs::models(), description.model, &brdfs::Model::name);
    common_ = description.model;
    auto state = [&, first = true](const std::string& key, const std::string& value) mutable {
        common_ += fmt::format("{}{}={}", first ? ':' : ',', key, value);
        first = false;
    };
    for (const auto& [key, word] : description.words) state(key, word);
    std::string firstPath;
    for (const DescribedParameter& described : description.parameters) {
        if (described.map.path.empty() && described.values.size() == 1) {
            state(described.name, fmt::format("{}", described.values[0]));
            continue;
        }
        VaryingParameter varying{
            .row = &*std::ranges::find(model->parameters, described.name, &Parameter::name)};
        std::unique_ptr<Map> map;
        if (described.map.path.empty()) {
            varying.channels = 3;
        } else {
            map = std::make_unique<Map>(described.map, *varying.row);
            varying.channels = map->channels();
            const PictureFile& picture = map->picture();
            if (firstPath.empty()) {
                firstPath = picture.path();
                width_ = picture.width();
                height_ = picture.height();
            } else if (picture.width() != width_ || picture.height() != height_) {
                picture.fail(
                    fmt::format("has {} x {} texels, and {} has {} x {}; all maps have "
                                "to have one size",
                                picture.width(), picture.height(), firstPath, width_, height_));
            }
        }
        values_ += varying.channels;
        varying_.push_back(varying);
        constants_.push_back(described.values);
        maps_.push_back(std::move(map));
    }
    if (firstPath.empty()) {
        throw InputError(
            fmt::format("{}: no parameter is a map; state one as {{\"map\": \"FILE\"}}, "
                        "or project one material",
                        description.file));
    }
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        varying_[k].low = INFINITY;
        varying_[k].high = -INFINITY;
        if (maps_[k]) {
            maps_[k]->check(varying_[k].low, varying_[k].high, listener);
        } else {
            varying_[k].low = *std::ranges::min_element(constants_[k]);
            varying_[k].high = *std::ranges::max_element(constants_[k]);
        }
    }
}

ParameterMaps::~ParameterMaps() = default;

std::vector<float> ParameterMaps::row(std::size_t row) {
    std::vector<float> values(values_ * width_);
    float* to = values.data();
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        if (maps_[k]) {
            maps_[k]->row(row, to);
        } else {
            for (std::size_t c = 0; c < varying_[k].channels; ++c)
                std::fill_n(to + c * width_, width_, static_cast<float>(constants_[k][c]));
        }
        to += varying_[k].channels * width_;
    }
    return values;
}

void ParameterMaps::checkIntact() const {
    for (const auto& map : maps_) {
        if (map) map->picture().checkIntact();
    }
}

}  // namespace hshfit::jobs
