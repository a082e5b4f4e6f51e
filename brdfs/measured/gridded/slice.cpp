#include <brdfs/measured/cell_measure.h>
#include <brdfs/measured/gridded/angle_block.h>
#include <brdfs/measured/gridded/half_difference_block.h>
#include <brdfs/measured/gridded/slice.h>
#include <hshfit/error.h>

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr double planeHalfWidth = 0.5;  // degrees: half a bin of a MERL table

double fraction(double i, double shift, std::size_t count) {
    return (i + shift) / static_cast<double>(count);
}

}  // namespace

double SliceLayout::thetaHalf(double i) const {
    const double x = fraction(i, shift, halfCount);
    return pi / 2 * (rootHalf ? x * x : x);
}

double SliceLayout::thetaDifference(double i) const {
    return pi / 2 * fraction(i, shift, differenceCount);
}

/// The nodes around a pair of angles, as indices of their first channel.
struct SliceBrdf::Corners {
    std::size_t node[8];
    double weight[8];
    std::size_t count;  ///< 4 or 8
};

SliceBrdf::SliceBrdf(SliceLayout layout, Channels channels, std::vector<float> stored,
                     std::string name, std::string kind)
    : layout_(std::move(layout)),
      channels_(std::move(channels)),
      values_(std::move(stored)),
      name_(std::move(name)),
      kind_(std::move(kind)) {
    assert(values_.size() == layout_.nodes() * channels_.count());
    const bool single = layout_.phi.size() == 1;
    laws_.reciprocal = single || layout_.period == 180;
    laws_.mirrorSymmetric = single;
    takeStock();
}

// Counts the stored values and marks the invalid ones.
void SliceBrdf::takeStock() {
    census_.values = values_.size();
    std::vector<double> cosines, sines;
    for (std::size_t h = 0; h < layout_.halfCount; ++h) {
        const double thetaHalf = layout_.thetaHalf(static_cast<double>(h));
        cosines.push_back(std::cos(thetaHalf));
        sines.push_back(std::sin(thetaHalf));
    }
    std::size_t at = 0;
    for (const double phi : layout_.phi) {
        for (std::size_t d = 0; d < layout_.differenceCount; ++d) {
            const double thetaDifference = layout_.thetaDifference(static_cast<double>(d));
            const double along = std::cos(thetaDifference);
            const double across = std::sin(thetaDifference) * std::fabs(std::cos(radians(phi)));
            for (std::size_t h = 0; h < layout_.halfCount; ++h) {
                const bool below = cosines[h] * along - sines[h] * across < 1e-12;
                for (std::size_t c = 0; c < channels_.count(); ++c, ++at) {
                    const float value = values_[at];
                    if (below) {
                        ++census_.belowHorizon;
                    } else if (std::isfinite(value) && value < 0) {
                        ++census_.invalid;
                    } else {
                        census_.add(static_cast<double>(value));
                        if (!std::isfinite(value) && damage_.empty()) {
                            damage_ = fmt::format(
                                "{}: the value of channel {} at theta_h {:.4g}, theta_d {:.4g}, "
                                "phi_d {} degrees is {}, expected a finite number",
                                name_, channels_.names()[c],
                                degrees(layout_.thetaHalf(static_cast<double>(h))),
                                degrees(thetaDifference), phi, value);
                        }
                    }
                    if (below || !std::isfinite(value) || value < 0) values_[at] = -1;
                }
            }
        }
    }
}

inline SliceBrdf::Corners SliceBrdf::corners(double thetaHalf, double thetaDifference,
                                             double phi) const {
    const double x = layout_.rootHalf ? std::sqrt(thetaHalf / 90) : thetaHalf / 90;
    const Between h =
        alongLine(x * static_cast<double>(layout_.halfCount) - layout_.shift, layout_.halfCount);
    const Between d = alongLine(
        thetaDifference / 90 * static_cast<double>(layout_.differenceCount) - layout_.shift,
        layout_.differenceCount);
    Between p;
    if (layout_.phi.size() > 1) {
        const double turned = layout_.period == 180 && phi >= 180 ? phi - 180 : phi;
        const auto above = std::ranges::upper_bound(layout_.phi, turned);
        const auto index = static_cast<std::size_t>(above - layout_.phi.begin());
        const std::size_t last = layout_.phi.size() - 1;
        p.low = index == 0 ? last : index - 1;
        p.high = index > last ? 0 : index;
        const double from = layout_.phi[p.low] - (index == 0 ? layout_.period : 0);
        const double to = layout_.phi[p.high] + (index > last ? layout_.period : 0);
        p.t = (turned - from) / (to - from);
    }
    Corners at;
    at.count = p.t > 0 ? 8 : 4;
    for (std::size_t i = 0; i < at.count; ++i) {
        const std::size_t plane = i & 4 ? p.high : p.low;
        const std::size_t row = plane * layout_.differenceCount + (i & 2 ? d.high : d.low);
        at.node[i] = (row * layout_.halfCount + (i & 1 ? h.high : h.low)) * channels_.count();
        at.weight[i] = (i & 4 ? p.t : 1 - p.t) * (i & 2 ? d.t : 1 - d.t) * (i & 1 ? h.t : 1 - h.t);
    }
    return at;
}

inline double SliceBrdf::interpolate(const Corners& at, std::size_t channel, double* weight) const {
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < at.count; ++i) {
        const float value = values_[at.node[i] + channel];
        const double w = value >= 0 ? at.weight[i] : 0;
        sum += w * value;
        total += w;
    }
    *weight = total;
    // The weights of valid nodes add up to 1 but for rounding if all are valid.
    return total > 0 ? sum / total : 0;
}

void SliceBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channelCount = channels_.count();
    if (!(wo.z > 0)) {
        std::fill_n(out, channelCount * wi.count, 0.0);
        return;
    }
    HalfDifferenceBlock angles;
    for (std::size_t begin = 0; begin < wi.count; begin += HalfDifferenceBlock::size) {
        const std::size_t count = std::min(HalfDifferenceBlock::size, wi.count - begin);
        angles.set(wo, wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            const bool above = wi.z[begin + k] > 0;
            const Corners at =
                corners(angles.thetaHalf[k], angles.thetaDifference[k], angles.phiDifference[k]);
            for (std::size_t c = 0; c < channelCount; ++c) {
                double weight;
                out[c * wi.count + begin + k] = above ? interpolate(at, c, &weight) : 0;
            }
        }
    }
}

void SliceBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    const double nearest = std::sin(radians(planeHalfWidth));
    HalfDifferenceBlock angles;
    for (std::size_t begin = 0; begin < wi.count; begin += HalfDifferenceBlock::size) {
        const std::size_t count = std::min(HalfDifferenceBlock::size, wi.count - begin);
        angles.set(wo, wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            const Corners at =
                corners(angles.thetaHalf[k], angles.thetaDifference[k], angles.phiDifference[k]);
            const double away = std::sin(radians(angles.thetaDifference[k])) *
                                std::sin(radians(angles.phiDifference[k] - layout_.phi.front()));
            bool rests = wo.z > 0 && wi.z[begin + k] > 0 &&
                         (layout_.phi.size() > 1 || std::fabs(away) <= nearest);
            for (std::size_t c = 0; c < channels_.count() && rests; ++c) {
                double weight;
                interpolate(at, c, &weight);
                rests = weight > 0;
            }
            covered[begin + k] = rests;
        }
    }
}

void SliceBrdf::giveCells(CellReceiver& receiver) const {
    const auto half = [&](double h) { return layout_.thetaHalf(h); };
    const double step = layout_.thetaDifference(1) - layout_.thetaDifference(0);
    const auto give = [&](const DirectionPair& pair, double measure) {
        if (std::min(pair.wi.z, pair.wo.z) <= 1e-12) return receiver.belowHorizon();
        unsigned char covered = 0;
        coverage(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1}, &covered);
        if (!covered) return receiver.invalid();
        receiver.add(pair, evaluate(*this, pair.wi, pair.wo), measure);
    };
    for (const double phi : layout_.phi)
        for (std::size_t d = 0; d < layout_.differenceCount; ++d)
            for (std::size_t h = 0; h < layout_.halfCount; ++h) {
                const double th = static_cast<double>(h);
                const double thetaD = layout_.thetaDifference(static_cast<double>(d));
                give(fromHalfDifference(half(th), 0, thetaD, radians(phi)),
                     cellMeasure(half, th, thetaD, step));
            }
}

std::vector<Lobe> SliceBrdf::lobes(const Direction& wo) const {
    const std::size_t rows = layout_.differenceCount, columns = layout_.halfCount;
    const double row = polarAngle(wo) / (pi / 2) * static_cast<double>(rows) - layout_.shift + 0.5;
    const auto d = std::min(static_cast<std::size_t>(std::max(row, 0.0)), rows - 1);
    const auto nearest =
        std::ranges::min_element(layout_.phi, {}, [](double phi) { return std::fabs(phi - 90); });
    const auto plane = static_cast<std::size_t>(nearest - layout_.phi.begin());
    // Brightness by theta_h; below 0 where a channel is invalid.
    std::vector<double> profile(columns, 0.0);
    double least = -1;
    for (std::size_t h = 0; h < columns; ++h) {
        for (std::size_t c = 0; c < channels_.count(); ++c) {
            const float value = values_[((plane * rows + d) * columns + h) * channels_.count() + c];
            profile[h] = value < 0 || profile[h] < 0 ? -1 : profile[h] + value;
        }
        if (profile[h] >= 0 && (least < 0 || profile[h] < least)) least = profile[h];
    }
    if (profile[0] < 0) return {};
    const double half = least + (profile[0] - least) / 2;
    std::size_t fallen = 1;
    while (fallen < columns && !(profile[fallen] >= 0 && profile[fallen] < half)) ++fallen;
    if (fallen >= columns) return {};
    // GGX falls to half where tan(theta_h) = sqrt(sqrt(2) - 1) alpha = 0.6436 alpha.
    const double slope = std::tan(layout_.thetaHalf(static_cast<double>(fallen)));
    return {{.about = Lobe::About::halfway, .width = std::min(slope / 0.6436, 1.0), .axis = {}}};
}

std::vector<Fact> SliceBrdf::facts() const {
    const bool single = layout_.phi.size() == 1;
    std::vector<Fact> facts = {
        {"format", kind_},
        {"dimensions", fmt::format("{} x {} x {}", layout_.halfCount, layout_.differenceCount,
                                   layout_.phi.size())},
        {"theta_half_nodes", layout_.rootHalf ? "square root" : "linear"},
        {"phi_difference",
         single ? fmt::format("only {} degrees; continued constantly", layout_.phi.front())
                : fmt::format("{} values of 0 to {} degrees", layout_.phi.size(), layout_.period)},
    };
    if (!layout_.stated)
        facts.emplace_back("taken_as",
                           "slices of a BRDF, since nothing in the file says what it holds; for "
                           "the light of a picture state a layout: FILE:layout=angular");
    // Slices are square, or nearly so; pictures of surroundings are twice as wide as high.
    if (single && layout_.halfCount == 2 * layout_.differenceCount) {
        facts.emplace_back("looks_like", "a lat-long environment map, which is no BRDF");
    }
    return facts;
}

std::vector<Axis> SliceBrdf::axes() const {
    const auto lastHalf = static_cast<double>(layout_.halfCount - 1);
    const auto lastDifference = static_cast<double>(layout_.differenceCount - 1);
    const auto gap = [](double last, const auto& angle) {
        return last > 0 ? degrees(angle(last) - angle(last - 1)) : 0;
    };
    double phiGap = 0;
    for (std::size_t i = 0; i < layout_.phi.size() && layout_.phi.size() > 1; ++i) {
        const bool lastOne = i + 1 == layout_.phi.size();
        const double next = lastOne ? layout_.phi[0] + layout_.period : layout_.phi[i + 1];
        phiGap = std::max(phiGap, next - layout_.phi[i]);
    }
    const auto half = [this](double i) { return layout_.thetaHalf(i); };
    const auto difference = [this](double i) { return layout_.thetaDifference(i); };
    return {{"theta_half", "degrees", layout_.halfCount, degrees(half(0)), degrees(half(lastHalf)),
             gap(lastHalf, half)},
            {"theta_difference", "degrees", layout_.differenceCount, degrees(difference(0)),
             degrees(difference(lastDifference)), gap(lastDifference, difference)},
            {"phi_difference", "degrees", layout_.phi.size(), layout_.phi.front(),
             layout_.phi.back(), phiGap}};
}

void SliceBrdf::checkIntact() const {
    if (!damage_.empty()) throw InputError(damage_);
}

}  // namespace hshfit::brdfs
