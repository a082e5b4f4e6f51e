#include <hshfit/lighting/harmonics.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/lighting/lobe_nodes.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace hshfit::lighting {
namespace {

constexpr int mostBands = 16;

Direction cross(const Direction& a, const Direction& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The texel of (l, m), and the first m that a table has.
struct HarmonicPlaces {
    bool inPlane;

    int first(int l) const { return inPlane ? 0 : -l; }
    std::size_t texel(int l, int m) const {
        return inPlane ? harmonicTexel(l, m) : static_cast<std::size_t>(slotOf(l, m));
    }
};

/// Moments of f cos(theta_i) with the harmonics, to the texels of a row.
void addMoments(const LobeNodes& nodes, const Basis& basis, std::span<double> row) {
    const HarmonicPlaces places{nodes.inPlane};
    constexpr std::size_t block = 4096;
    std::vector<double> values;
    const auto slots = static_cast<std::size_t>(basis.slots());
    for (std::size_t first = 0; first < nodes.count(); first += block) {
        const std::size_t count = std::min(block, nodes.count() - first);
        values.resize(count * slots);
        basis.evaluateColumns({&nodes.x[first], &nodes.y[first], &nodes.z[first], count},
                              values.data());
        for (int l = 0; l < basis.order(); ++l) {
            for (int m = places.first(l); m <= l; ++m) {
                const double* function =
                    values.data() + static_cast<std::size_t>(slotOf(l, m)) * count;
                for (std::size_t c = 0; c < 3; ++c) {
                    double sum = 0;
                    for (std::size_t k = 0; k < count; ++k)
                        sum += function[k] * nodes.f[c][first + k] * nodes.z[first + k] *
                               nodes.weights[first + k];
                    row[places.texel(l, m) * 4 + c] += sum;
                }
            }
        }
    }
}

}  // namespace

ViewAxes::ViewAxes(const Direction& normal, const Direction& viewer, const Direction& tangent)
    : z(normal) {
    cosine = dot(normal, viewer);
    x = {viewer.x - cosine * z.x, viewer.y - cosine * z.y, viewer.z - cosine * z.z};
    double length = std::sqrt(dot(x, x));
    if (!(length > 1e-6)) {
        // Any tangent will do: without one, the lobe is one of revolution there.
        x = tangent;
        if (dot(x, x) == 0) x = std::abs(z.x) < 0.5 ? cross({1, 0, 0}, z) : cross({0, 1, 0}, z);
        length = std::sqrt(dot(x, x));
    }
    x = {x.x / length, x.y / length, x.z / length};
    y = cross(z, x);
    if (dot(tangent, tangent) > 0) azimuth = std::atan2(dot(x, cross(z, tangent)), dot(x, tangent));
}
void ViewAxes::mirror() {
    y = {-y.x, -y.y, -y.z};
}
Direction ViewAxes::toLocal(const Direction& world) const {
    return {dot(world, x), dot(world, y), dot(world, z)};
}
Direction ViewAxes::toWorld(const Direction& d) const {
    return {d.x * x.x + d.y * y.x + d.z * z.x, d.x * x.y + d.y * y.y + d.z * z.y,
            d.x * x.z + d.y * y.z + d.z * z.z};
}

HarmonicTable fitHarmonics(const Brdf& brdf, int order, ElevationRows rows,
                           std::size_t azimuthSteps) {
    if (order < 1 || order > mostBands)
        throw UsageError(
            fmt::format("{} bands of light: from 1 to {} are possible", order, mostBands));
    const auto basis = bases::make("sh", order);
    const bool inPlane = lobesInPlane(brdf.laws());
    const auto texels = static_cast<std::size_t>(inPlane ? order * (order + 1) / 2 : order * order);
    const AzimuthNodes azimuths(brdf.laws(), azimuthSteps);
    HarmonicTable result{
        .order = order, .inPlane = inPlane, .table = ElevationTable(rows, texels, azimuths)};
    tbb::parallel_for(std::size_t{0}, result.table.height(), [&](std::size_t place) {
        const std::size_t k = place % rows.count, around = place / rows.count;
        addMoments(viewNodes(brdf, rows.cosine(k), azimuths.angle(around), order), *basis,
                   result.table.row(k, around));
    });
    return result;
}

HarmonicShading::HarmonicShading(HarmonicTable table, const LightCoefficients& light)
    : table_(std::move(table)), rotation_(std::make_shared<ShRotation>(table_.order)) {
    assert(light.order >= table_.order && light.channels.count() == 3 && !light.condonShortley);
    const auto slots = static_cast<std::size_t>(table_.order * table_.order);
    light_.resize(slots);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < slots; ++i) {
            light_[i][c] = light.at(c)[i];
            planes_.push_back(light.at(c)[i]);
        }
    }
}

Rgb HarmonicShading::radiance(const Direction& normal, const Direction& viewer,
                              const Direction& tangent) const {
    const ViewAxes axes(normal, viewer, tangent);
    if (!(axes.cosine > 0)) return {};
    const Rotation toLocal = Rotation::fromMatrix(
        {axes.x.x, axes.x.y, axes.x.z, axes.y.x, axes.y.y, axes.y.z, axes.z.x, axes.z.y, axes.z.z});
    std::vector<double> local(planes_.size());
    rotation_->rotate({&toLocal, 1}, 3, planes_.data(), local.data());
    std::vector<double> row(table_.table.texels * 4);
    const bool mirrored = table_.table.at(axes.cosine, axes.azimuth, row);
    const HarmonicPlaces places{table_.inPlane};
    Rgb sum{};
    const std::size_t slots = light_.size();
    for (int l = 0; l < table_.order; ++l)
        for (int m = places.first(l); m <= l; ++m)
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += (mirrored && m < 0 ? -1 : 1) * row[places.texel(l, m) * 4 + c] *
                          local[c * slots + static_cast<std::size_t>(slotOf(l, m))];
    return sum;
}

}  // namespace hshfit::lighting
