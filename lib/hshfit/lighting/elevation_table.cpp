#include <hshfit/lighting/elevation_table.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::lighting {

double ElevationRows::cosine(std::size_t row) const {
    const double u = static_cast<double>(row) / static_cast<double>(count - 1);
    return 1 - (1 - leastCosine) * u * u;
}

ElevationRows::Place ElevationRows::place(double cosine) const {
    const double u = std::sqrt(std::clamp((1 - cosine) / (1 - leastCosine), 0.0, 1.0));
    const double position = u * static_cast<double>(count - 1);
    const auto row = std::min(static_cast<std::size_t>(position), count - 2);
    return {row, position - static_cast<double>(row)};
}

ElevationTable::ElevationTable(ElevationRows where, std::size_t each)
    : rows(where), texels(each), values(where.count * each * 4, 0.0) {}

std::span<double> ElevationTable::row(std::size_t k) {
    return {values.data() + k * texels * 4, texels * 4};
}
std::span<const double> ElevationTable::row(std::size_t k) const {
    return {values.data() + k * texels * 4, texels * 4};
}

void ElevationTable::at(double cosine, std::span<double> out) const {
    assert(out.size() == texels * 4);
    const auto [first, share] = rows.place(cosine);
    const auto a = row(first), b = row(first + 1);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = a[i] + share * (b[i] - a[i]);
}

}  // namespace hshfit::lighting
