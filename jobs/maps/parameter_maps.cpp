#include "parameter_maps.h"

#include <hshfit/error.h>
#include <hshfit/light/picture_reader.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {

/// One picture and its channels as values of a parameter.
class ParameterMaps::Map {
public:
    Map(const MapReference& reference, const Parameter& parameter)
        : reference_(reference),
          parameter_(parameter),
          rows_(reference.path, reference.channels,
                parameter.kind == Parameter::Kind::colour ? std::vector<std::string>{"R", "G", "B"}
                                                          : std::vector<std::string>{}) {
        if (!picture().wholeNumbers() && reference.curve != TransferCurve::linear) {
            picture().fail(fmt::format("its {} values are linear, not coded by {}",
                                       picture().number(), curveName(reference.curve)));
        }
    }

    const PictureFile& picture() const { return rows_.picture(); }
    std::size_t channels() const { return rows_.channels(); }

    /// out[channel][column]
    void row(std::size_t row, float* out) {
        rows_.row(row, out);
        for (std::size_t k = 0; k < channels() * picture().width(); ++k) out[k] = value(out[k]);
    }

    /// Reads some rows; the range of the values that occur.
    void check(const ItemRange& rows, double& low, double& high, const Listener& listener) {
        const auto progress = listener.part(fmt::format("checking {}", picture().path()));
        const std::size_t width = picture().width();
        std::vector<float> values(width * channels());
        for (std::size_t y = rows.first; y < rows.last; ++y) {
            row(y, values.data());
            for (std::size_t k = 0; k < values.size(); ++k) {
                const auto v = static_cast<double>(values[k]);
                // Bounds are compared in the precision of the values.
                if (!(values[k] >= static_cast<float>(parameter_.min) &&
                      values[k] <= static_cast<float>(parameter_.max))) {
                    picture().fail(fmt::format("texel ({}, {}): {} is {:g}; valid: {}", k % width,
                                               y, parameter_.name, v, validValues(parameter_)));
                }
                low = std::min(low, v);
                high = std::max(high, v);
            }
            if (progress) progress(y + 1 - rows.first, rows.last - rows.first);
        }
    }

private:
    float value(float stored) const {
        double v = static_cast<double>(stored);
        if (reference_.curve != TransferCurve::linear) v = decoded(reference_.curve, v);
        if (reference_.power != 1) v = std::pow(v, reference_.power);
        return static_cast<float>(reference_.offset + reference_.scale * v);
    }

    MapReference reference_;
    const Parameter& parameter_;
    ChannelRows rows_;
};

ParameterMaps::ParameterMaps(const MaterialDescription& description, Processes& processes,
                             const Listener& listener) {
    const auto model = std::ranges::find(brdfs::models(), description.model, &brdfs::Model::name);
    common_ = description.model;
    auto state = [&, first = true](const std::string& key, const std::string& value) mutable {
        common_ += fmt::format("{}{}={}", first ? ':' : ',', key, value);
        first = false;
    };
    for (const auto& [key, word] : description.words) state(key, word);
    std::string firstPath;
    const auto checkSize = [&](const PictureFile& picture) {
        if (firstPath.empty()) {
            firstPath = picture.path();
            width_ = picture.width();
            height_ = picture.height();
        } else if (picture.width() != width_ || picture.height() != height_) {
            picture.fail(
                fmt::format("has {} x {} texels, and {} has {} x {}; all maps have to have "
                            "one size",
                            picture.width(), picture.height(), firstPath, width_, height_));
        }
    };
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
            checkSize(map->picture());
        }
        values_ += varying.channels;
        varying_.push_back(varying);
        constants_.push_back(described.values);
        maps_.push_back(std::move(map));
    }
    turns_ = std::make_unique<TurnMaps>(description, checkSize);
    if (firstPath.empty()) {
        throw InputError(
            fmt::format("{}: no parameter is a map; state one as {{\"map\": \"FILE\"}}, "
                        "or project one material",
                        description.file));
    }
    check(processes, listener);
    turns_->check(processes.share(height_), listener);
    std::vector<std::size_t> renormalised(processes.count());
    renormalised[processes.number()] = turns_->renormalised();
    gatherValues(processes, renormalised.size(), renormalised);
    for (const std::size_t ofProcess : renormalised) renormalised_ += ofProcess;
}

/// Rows are shared out among processes.
void ParameterMaps::check(Processes& processes, const Listener& listener) {
    const std::size_t count = processes.count(), stride = 2 * varying_.size();
    std::vector<double> ranges(count * stride);
    double* own = ranges.data() + processes.number() * stride;
    const ItemRange rows = processes.share(height_);
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        double &low = own[2 * k] = INFINITY, &high = own[2 * k + 1] = -INFINITY;
        if (maps_[k]) {
            maps_[k]->check(rows, low, high, listener);
        } else {
            low = *std::ranges::min_element(constants_[k]);
            high = *std::ranges::max_element(constants_[k]);
        }
    }
    if (stride > 0) gatherValues(processes, count, ranges);
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        varying_[k].low = ranges[2 * k];
        varying_[k].high = ranges[2 * k + 1];
        for (std::size_t p = 1; p < count; ++p) {
            varying_[k].low = std::min(varying_[k].low, ranges[p * stride + 2 * k]);
            varying_[k].high = std::max(varying_[k].high, ranges[p * stride + 2 * k + 1]);
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
    turns_->checkIntact();
}

}  // namespace hshfit::jobs
