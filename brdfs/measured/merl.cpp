#include <brdfs/measured/merl.h>
#include <hshfit/error.h>

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace hshfit::brdfs {

static_assert(std::endian::native == std::endian::little, "MERL files are little-endian");

namespace {

constexpr std::size_t blockSize = MerlIndices::size;

MerlLayout checkedLayout(const MappedFile& file) {
    if (file.size() < MerlLayout::headerBytes) {
        throw InputError(
            fmt::format("{}: {} bytes are too few for the 12-byte header of a MERL "
                        "file (int32 90, 90, 180)",
                        file.path(), file.size()));
    }
    std::int32_t dimensions[3];
    std::memcpy(dimensions, file.data(), sizeof dimensions);
    constexpr const char* names[] = {"theta_h", "theta_d", "phi_d"};
    for (int i = 0; i < 3; ++i) {
        const bool valid =
            i < 2 ? dimensions[i] == 90 : dimensions[i] == 180 || dimensions[i] == 360;
        if (!valid) {
            throw InputError(fmt::format("{}: dimension {} ({}, offset {}) is {}, expected {}",
                                         file.path(), i, names[i], 4 * i, dimensions[i],
                                         i < 2 ? "90" : "180, or 360 if not reciprocal"));
        }
    }
    const MerlLayout layout{.azimuthCount = static_cast<std::size_t>(dimensions[2])};
    if (file.size() != layout.fileBytes()) {
        throw InputError(
            fmt::format("{}: the file has {} bytes, expected {} for 90 x 90 x {} "
                        "cells in three channels",
                        file.path(), file.size(), layout.fileBytes(), layout.azimuthCount));
    }
    return layout;
}

bool isValue(double v) {
    return v >= 0 && v <= std::numeric_limits<double>::max();
}

}  // namespace

MerlBrdf::MerlBrdf(const std::string& path, MerlInterpolation interpolation)
    : file_(path), interpolation_(interpolation), layout_(checkedLayout(file_)) {
    laws_.nonNegative = true;
    laws_.isotropic = true;
    laws_.reciprocal = layout_.azimuthCount == 180;
}

std::string MerlBrdf::name() const {
    return interpolation_ == MerlInterpolation::nearest ? file_.path() + ":interpolation=nearest"
                                                        : file_.path();
}

// The cells follow a 12-byte header and are therefore not aligned.
inline double MerlBrdf::raw(std::size_t channel, std::size_t cell) const {
    double value;
    std::memcpy(&value,
                file_.data() + MerlLayout::headerBytes +
                    (channel * layout_.cells() + cell) * sizeof(double),
                sizeof value);
    return value;
}

double MerlBrdf::stored(std::size_t channel, std::size_t cell) const {
    return raw(channel, cell) * merlScale[channel];
}

void MerlBrdf::remember(std::size_t channel, std::size_t cell) const {
    corruptCell_.store(static_cast<std::int64_t>(channel * layout_.cells() + cell),
                       std::memory_order_relaxed);
}

double MerlBrdf::averageOfValid(const MerlCorners& at, std::size_t k, const double (&across)[4],
                                std::size_t channel) const {
    double sum = 0, weight = 0;
    for (int i = 0; i < 8; ++i) {
        const double w = across[i / 2] * (i % 2 == 0 ? 1 - at.tp[k] : at.tp[k]);
        if (w <= 0) continue;
        const std::size_t cell = at.row[i / 2][k] + (i % 2 == 0 ? at.p0[k] : at.p1[k]);
        const double v = raw(channel, cell);
        if (isValue(v)) {
            sum += w * v;
            weight += w;
        } else if (!std::isfinite(v)) {
            remember(channel, cell);
        }
    }
    return weight > 0 ? sum / weight : 0;
}

inline MerlBrdf::Pair MerlBrdf::rawPair(std::size_t channel, const MerlCorners& at, int row,
                                        std::size_t k) const {
    const std::size_t first = at.row[row][k] + at.p0[k];
    if (at.p1[k] == 0) [[unlikely]] {
        return Pair{raw(channel, first), raw(channel, at.row[row][k])};
    }
    Pair pair;
    std::memcpy(&pair,
                file_.data() + MerlLayout::headerBytes +
                    (channel * layout_.cells() + first) * sizeof(double),
                sizeof pair);
    return pair;
}

inline void MerlBrdf::interpolateLinear(const MerlCorners& at, std::size_t k, double* out,
                                        std::size_t stride) const {
    const double th = at.th[k], td = at.td[k], tp = at.tp[k];
    const double across[4] = {(1 - th) * (1 - td), (1 - th) * td, th * (1 - td), th * td};
    for (std::size_t c = 0; c < 3; ++c) {
        Pair pair = {};
        PairBits bits = {};
        for (int i = 0; i < 4; ++i) {
            const Pair cells = rawPair(c, at, i, k);
            pair += across[i] * cells;
            bits |= std::bit_cast<PairBits>(cells);
        }
        double sum = pair[0] + tp * (pair[1] - pair[0]);
        // A sign bit, NaN or infinity: only the valid cells count.
        if (((bits[0] | bits[1]) < 0) || !isValue(sum)) [[unlikely]] {
            sum = averageOfValid(at, k, across, c);
        }
        out[c * stride] = sum * merlScale[c];
    }
}

inline void MerlBrdf::lookUpNearest(const MerlIndices& at, std::size_t k, double* out,
                                    std::size_t stride) const {
    const std::size_t cell =
        layout_.cell(static_cast<unsigned>(at.h[k]), static_cast<unsigned>(at.d[k]),
                     static_cast<unsigned>(at.p[k]));
    for (std::size_t c = 0; c < 3; ++c) {
        const double v = raw(c, cell);
        if (!std::isfinite(v)) remember(c, cell);
        out[c * stride] = isValue(v) ? v * merlScale[c] : 0;
    }
}

void MerlBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    if (!(wo.z > 0)) {
        std::fill_n(out, 3 * wi.count, 0.0);
        return;
    }
    MerlIndices at;
    MerlCorners corners;
    const bool linear = interpolation_ == MerlInterpolation::linear;
    for (std::size_t begin = 0; begin < wi.count; begin += blockSize) {
        const std::size_t count = std::min(blockSize, wi.count - begin);
        at.set(wo, {wi.x + begin, wi.y + begin, wi.z + begin, count}, layout_);
        std::uint64_t open = ~std::uint64_t{0};
        if (linear) {
            corners.set(at, count, layout_);
            open = corners.blend(file_.data() + MerlLayout::headerBytes, layout_, wi.z + begin,
                                 count, out + begin, wi.count);
        } else {
            at.round(count, layout_.azimuthCount);
        }
        for (std::size_t k = 0; k < count && open != 0; ++k, open >>= 1) {
            if ((open & 1) == 0) continue;
            double* to = out + begin + k;
            if (!(wi.z[begin + k] > 0)) {
                for (std::size_t c = 0; c < 3; ++c) to[c * wi.count] = 0;
            } else if (linear) {
                interpolateLinear(corners, k, to, wi.count);
            } else {
                lookUpNearest(at, k, to, wi.count);
            }
        }
    }
}

bool MerlBrdf::rests(const MerlCorners& at, std::size_t k) const {
    int valid = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        bool any = false;
        for (int i = 0; i < 8 && !any; ++i) {
            const double t[3] = {i & 4 ? at.th[k] : 1 - at.th[k], i & 2 ? at.td[k] : 1 - at.td[k],
                                 i & 1 ? at.tp[k] : 1 - at.tp[k]};
            if (t[0] * t[1] * t[2] <= 0) continue;
            any = isValue(raw(c, at.row[i / 2][k] + (i % 2 == 0 ? at.p0[k] : at.p1[k])));
        }
        valid += any;
    }
    return valid == 3;
}

void MerlBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    MerlIndices at;
    MerlCorners corners;
    for (std::size_t begin = 0; begin < wi.count; begin += blockSize) {
        const std::size_t count = std::min(blockSize, wi.count - begin);
        at.set(wo, {wi.x + begin, wi.y + begin, wi.z + begin, count}, layout_);
        if (interpolation_ == MerlInterpolation::nearest) at.round(count, layout_.azimuthCount);
        corners.set(at, count, layout_);
        for (std::size_t k = 0; k < count; ++k) {
            const bool above = wo.z > 0 && wi.z[begin + k] > 0;
            covered[begin + k] = above && rests(corners, k);
        }
    }
}

void MerlBrdf::checkIntact() const {
    file_.checkIntact();
    const std::int64_t corrupt = corruptCell_.load(std::memory_order_relaxed);
    if (corrupt < 0) return;
    const auto index = static_cast<std::size_t>(corrupt);
    const std::size_t channel = index / layout_.cells(), cell = index % layout_.cells();
    const std::size_t p = cell % layout_.azimuthCount, row = cell / layout_.azimuthCount;
    throw InputError(
        fmt::format("{}: cell (theta_h {}, theta_d {}, phi_d {}) of channel {}, "
                    "offset {}, is {}, expected a finite number",
                    file_.path(), row / 90, row % 90, p, "RGB"[channel],
                    MerlLayout::headerBytes + index * sizeof(double), stored(channel, cell)));
}

}  // namespace hshfit::brdfs
