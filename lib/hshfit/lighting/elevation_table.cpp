#include <hshfit/lighting/elevation_table.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::lighting {

double ElevationRows::cosine(std::size_t row) const {
    const double u = static_cast<double>(row) / static_cast<double>(count - 1);
    return std::pow(1 - span() * u * u, 2);
}

ElevationRows::Place ElevationRows::place(double cosine) const {
    const double root = std::sqrt(std::max(0.0, cosine));
    const double u = std::sqrt(std::clamp((1 - root) / span(), 0.0, 1.0));
    const double position = u * static_cast<double>(count - 1);
    const auto row = std::min(static_cast<std::size_t>(position), count - 2);
    return {row, position - static_cast<double>(row)};
}

AzimuthNodes::AzimuthNodes(const Laws& laws, std::size_t steps) {
    assert(steps > 0);
    if (laws.isotropic) return;
    folded = laws.mirrorSymmetric;
    count = folded ? steps + 1 : 4 * steps;
}

double AzimuthNodes::angle(std::size_t node) const {
    const auto k = static_cast<double>(node), n = static_cast<double>(count);
    if (count == 1) return 0;
    return folded ? pi / 2 * k / (n - 1) : 2 * pi * k / n;
}

AzimuthNodes::Place AzimuthNodes::place(double azimuth) const {
    if (count == 1) return {};
    const double x = std::cos(azimuth), y = std::sin(azimuth);
    if (folded) {
        const double turn = std::atan2(std::abs(y), std::abs(x)) / (pi / 2);
        const double position = turn * static_cast<double>(count - 1);
        const auto first = std::min(static_cast<std::size_t>(position), count - 2);
        return {first, first + 1, position - static_cast<double>(first), x * y < 0};
    }
    const auto n = static_cast<double>(count);
    const double position = std::atan2(y, x) / (2 * pi) * n + (y < 0 ? n : 0);
    const auto first = std::min(static_cast<std::size_t>(position), count - 1);
    return {first, (first + 1) % count, position - static_cast<double>(first), false};
}

ElevationTable::ElevationTable(ElevationRows where, std::size_t each, AzimuthNodes around)
    : rows(where),
      azimuths(around),
      texels(each),
      values(where.count * around.count * each * 4, 0.0) {}

std::span<double> ElevationTable::row(std::size_t k, std::size_t azimuth) {
    return {values.data() + (azimuth * rows.count + k) * texels * 4, texels * 4};
}
std::span<const double> ElevationTable::row(std::size_t k, std::size_t azimuth) const {
    return {values.data() + (azimuth * rows.count + k) * texels * 4, texels * 4};
}

bool ElevationTable::at(double cosine, double azimuth, std::span<double> out) const {
    assert(out.size() == texels * 4);
    const auto [first, share] = rows.place(cosine);
    const AzimuthNodes::Place around = azimuths.place(azimuth);
    const auto a = row(first, around.first), b = row(first + 1, around.first);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = a[i] + share * (b[i] - a[i]);
    if (azimuths.count == 1) return false;
    const auto c = row(first, around.second), d = row(first + 1, around.second);
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] += around.share * (c[i] + share * (d[i] - c[i]) - out[i]);
    return around.mirrored;
}

}  // namespace hshfit::lighting
