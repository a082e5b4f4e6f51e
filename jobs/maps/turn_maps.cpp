#include "turn_maps.h"

#include <fmt/format.h>

#include <cmath>

namespace hshfit::jobs {
namespace {

constexpr double lengthTolerance = 0.05;  // 8-bit codes are off by 0.7 % at most

bool isSigned(const PictureFile& picture, VectorCodes codes) {
    return codes == VectorCodes::automatic ? !picture.wholeNumbers()
                                           : codes == VectorCodes::signedValues;
}

std::string placeOf(std::size_t column, std::size_t row) {
    return fmt::format("texel ({}, {})", column, row);
}

}  // namespace

TurnMaps::TurnMaps(const MaterialDescription& description,
                   const std::function<void(const PictureFile&)>& checkSize) {
    if (description.normal) {
        normal_ = *description.normal;
        normals_ = std::make_unique<ChannelRows>(normal_.path, normal_.channels,
                                                 std::vector<std::string>{"R", "G", "B"});
        checkSize(normals_->picture());
        if (normals_->channels() < 2) {
            normals_->picture().fail(
                "has one channel; a map of normals has three, or two of which z follows");
        }
    }
    if (!description.direction) return;
    direction_ = *description.direction;
    azimuth_ = radians(direction_.degrees);
    if (direction_.path.empty()) return;
    const bool vector = direction_.unit == DirectionUnit::vector;
    directions_ = std::make_unique<ChannelRows>(
        direction_.path, direction_.channels,
        vector ? std::vector<std::string>{"R", "G"} : std::vector<std::string>{"R"});
    checkSize(directions_->picture());
    if (vector && directions_->channels() != 2)
        directions_->picture().fail("has one channel; a direction as a vector has two");
}

void TurnMaps::check(const ItemRange& rows, const Listener& listener) {
    for (const ChannelRows* map : {normals_.get(), directions_.get()}) {
        if (map == nullptr) continue;
        const auto progress = listener.part(fmt::format("checking {}", map->picture().path()));
        std::vector<TexelTurn> turns;
        for (std::size_t y = rows.first; y < rows.last; ++y) {
            turns.assign(map->picture().width(), {});
            if (map == normals_.get())
                addNormals(y, turns);
            else
                addDirections(y, turns);
            if (progress) progress(y + 1 - rows.first, rows.last - rows.first);
        }
    }
}

std::vector<TexelTurn> TurnMaps::row(std::size_t row, std::size_t width) {
    std::vector<TexelTurn> turns(width, {{0, 0, 1}, azimuth_});
    const std::size_t before = renormalised_;
    if (normals_) addNormals(row, turns);
    renormalised_ = before;
    if (directions_) addDirections(row, turns);
    return turns;
}

void TurnMaps::addNormals(std::size_t row, std::vector<TexelTurn>& turns) {
    const std::size_t width = turns.size();
    const PictureFile& picture = normals_->picture();
    std::vector<float> values(width * normals_->channels());
    normals_->row(row, values.data());
    const double factor = isSigned(picture, normal_.codes) ? 1 : 2;
    const auto component = [&](std::size_t channel, std::size_t x) {
        return factor * static_cast<double>(values[channel * width + x]) - (factor - 1);
    };
    for (std::size_t x = 0; x < width; ++x) {
        Direction n{component(0, x), component(1, x), 0};
        const double square = n.x * n.x + n.y * n.y;
        if (normals_->channels() > 2)
            n.z = component(2, x);
        else
            n.z = square < 1 ? std::sqrt(1 - square) : square >= 1 ? 0 : square;
        const double length = std::sqrt(square + n.z * n.z);
        const auto refuse = [&](const std::string& what) {
            picture.fail(fmt::format("{}: the normal is ({:.4g}, {:.4g}, {:.4g}){}",
                                     placeOf(x, row), n.x, n.y, n.z, what));
        };
        if (!std::isfinite(length)) refuse("; finite numbers are needed");
        if (!(n.z > 0)) refuse(", which is not above the surface; z has to be above 0");
        if (std::abs(length - 1) > lengthTolerance) {
            if (!normal_.renormalise) {
                refuse(
                    fmt::format(", of length {:.3g}; 1 is needed, or \"lengths\": "
                                "\"renormalise\" in the description",
                                length));
            }
            ++renormalised_;
        }
        const double y = (normal_.yDown ? -1 : 1) * normal_.scale * n.y;
        n = {normal_.scale * n.x, y, n.z};
        const double scaled = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        turns[x].normal = {n.x / scaled, n.y / scaled, n.z / scaled};
    }
}

void TurnMaps::addDirections(std::size_t row, std::vector<TexelTurn>& turns) {
    const std::size_t width = turns.size();
    const PictureFile& picture = directions_->picture();
    std::vector<float> values(width * directions_->channels());
    directions_->row(row, values.data());
    const double factor = isSigned(picture, direction_.codes) ? 1 : 2;
    const double sign = direction_.yDown ? -1 : 1;
    for (std::size_t x = 0; x < width; ++x) {
        const auto first = static_cast<double>(values[x]);
        double angle = 0;
        if (direction_.unit == DirectionUnit::vector) {
            const double u = factor * first - (factor - 1),
                         v = factor * static_cast<double>(values[width + x]) - (factor - 1);
            // 8-bit codes of 0 are off by 0.004.
            if (!(std::hypot(u, v) > 0.01) || !std::isfinite(u + v)) {
                picture.fail(
                    fmt::format("{}: the direction is ({:.4g}, {:.4g}); a finite vector "
                                "other than 0 is needed",
                                placeOf(x, row), u, v));
            }
            angle = std::atan2(v, u);
        } else {
            angle = direction_.offset + direction_.scale * first;
            if (!std::isfinite(angle)) {
                picture.fail(fmt::format("{}: the direction is {:g}; a finite angle is needed",
                                         placeOf(x, row), angle));
            }
            if (direction_.unit == DirectionUnit::degrees) angle = radians(angle);
            if (direction_.unit == DirectionUnit::turns) angle *= 2 * pi;
        }
        turns[x].azimuth = sign * angle;
    }
}

void TurnMaps::checkIntact() const {
    for (const ChannelRows* map : {normals_.get(), directions_.get()})
        if (map != nullptr) map->picture().checkIntact();
}

}  // namespace hshfit::jobs
