#include <brdfs/measured/rgl_tables.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

double lerp(double t, double from, double to) {
    return from + t * (to - from);
}

/// The position of `value` among ascending nodes: the lower node and the weight of the next.
struct Between {
    std::size_t lower = 0;
    double fraction = 0;
};

Between locate(const std::vector<double>& nodes, double value) {
    if (nodes.size() < 2 || !(value > nodes.front())) return {};
    // The nodes are few, so that counting those below is faster than bisection.
    std::size_t lower = 0;
    for (std::size_t i = 1; i + 1 < nodes.size(); ++i) lower += nodes[i] <= value ? 1 : 0;
    const double fraction = (value - nodes[lower]) / (nodes[lower + 1] - nodes[lower]);
    return {lower, std::min(fraction, 1.0)};
}

}  // namespace

Slices IncidentGrid::slices(double phiIncident, double thetaIncident) const {
    const Between p = locate(phi, phiIncident), t = locate(theta, thetaIncident);
    Slices slices;
    for (int i = 0; i < 4; ++i) {
        const std::size_t dp = i / 2, dt = i % 2;
        const double weight =
            (dp != 0 ? p.fraction : 1 - p.fraction) * (dt != 0 ? t.fraction : 1 - t.fraction);
        if (weight <= 0) continue;
        slices.index[slices.count] =
            static_cast<std::uint32_t>((p.lower + dp) * theta.size() + t.lower + dt);
        slices.weight[slices.count] = weight;
        ++slices.count;
    }
    return slices;
}

VisibleNormals::VisibleNormals(const std::vector<float>& densities, std::size_t rows,
                               std::size_t columns)
    : rows_(rows), columns_(columns) {
    const std::size_t slices = densities.size() / (rows * columns);
    vertices_.reserve(densities.size());
    rowSums_.reserve(slices * rows);
    for (std::size_t s = 0; s < slices; ++s) {
        double square = 0, lastRow = 0;
        for (std::size_t r = 0; r < rows; ++r) {
            const float* density = densities.data() + (s * rows + r) * columns;
            double row = 0;
            for (std::size_t c = 0; c < columns; ++c) {
                if (c > 0) row += 0.5 * (static_cast<double>(density[c - 1]) + density[c]);
                vertices_.push_back({density[c], static_cast<float>(row)});
            }
            if (r > 0) square += 0.5 * (lastRow + row);
            rowSums_.push_back({static_cast<float>(row), static_cast<float>(square)});
            lastRow = row;
        }
        scale_.push_back(1 / square);
    }
}

// All sums over slices are linear, so that interpolating the integrals gives exactly the integrals
// of the interpolated density.
VisibleNormals::Point VisibleNormals::invert(double u, double v, const Slices& slices) const {
    const GridPosition p(u, v, columns_, rows_);
    double low = 0, high = 0, before = 0;          // along the row at v
    double rowBelow = 0, rowAbove = 0, below = 0;  // whole rows
    for (int i = 0; i < slices.count; ++i) {
        const double weight = slices.weight[i] * scale_[slices.index[i]];
        const std::size_t row = slices.index[i] * rows_ + p.row;
        const Vertex* lower = vertices_.data() + row * columns_;
        const Vertex* upper = lower + columns_;
        low += weight * lerp(p.b, lower[p.column].density, upper[p.column].density);
        high += weight * lerp(p.b, lower[p.column + 1].density, upper[p.column + 1].density);
        before += weight * lerp(p.b, lower[p.column].before, upper[p.column].before);
        rowBelow += weight * lower[columns_ - 1].before;
        rowAbove += weight * upper[columns_ - 1].before;
        below += weight * rowSums_[row].below;
    }
    const double whole = lerp(p.b, rowBelow, rowAbove);
    const double part = before + p.a * (low + 0.5 * p.a * (high - low));
    return {.x = whole > 0 ? part / whole : u,
            .y = below + p.b * (rowBelow + 0.5 * p.b * (rowAbove - rowBelow))};
}

namespace {

/// t in [0, 1] with the integral from 0 to t of lerp(., low, high) equal to `area`.
double inverseTrapezoid(double low, double high, double area) {
    const double root = std::sqrt(std::max(low * low + 2 * (high - low) * area, 0.0));
    return low + root > 0 ? std::clamp(2 * area / (low + root), 0.0, 1.0) : 0;
}

}  // namespace

VisibleNormals::Point VisibleNormals::sample(double x, double y, std::size_t slice) const {
    const RowSum* sums = rowSums_.data() + slice * rows_;
    const double area = std::clamp(y, 0.0, 1.0) / scale_[slice];
    const auto above =
        std::upper_bound(sums + 1, sums + rows_ - 1, area,
                         [](double wanted, const RowSum& sum) { return wanted < sum.below; });
    const auto row = static_cast<std::size_t>(above - sums) - 1;
    const Vertex* lower = vertices_.data() + (slice * rows_ + row) * columns_;
    const Vertex* upper = lower + columns_;
    const double b = inverseTrapezoid(lower[columns_ - 1].before, upper[columns_ - 1].before,
                                      area - sums[row].below);

    const auto before = [&](std::size_t c) { return lerp(b, lower[c].before, upper[c].before); };
    const double whole = before(columns_ - 1), part = std::clamp(x, 0.0, 1.0) * whole;
    const double v = (static_cast<double>(row) + b) / static_cast<double>(rows_ - 1);
    if (!(whole > 0)) return {x, v};
    std::size_t column = 0, end = columns_ - 1;  // before(column) <= part < before(end)
    while (end - column > 1) {
        const std::size_t middle = (column + end) / 2;
        (before(middle) <= part ? column : end) = middle;
    }
    const double a = inverseTrapezoid(lerp(b, lower[column].density, upper[column].density),
                                      lerp(b, lower[column + 1].density, upper[column + 1].density),
                                      part - before(column));
    return {(static_cast<double>(column) + a) / static_cast<double>(columns_ - 1), v};
}

double VisibleNormals::density(double u, double v, std::size_t slice) const {
    const GridPosition p(u, v, columns_, rows_);
    const Vertex* lower = vertices_.data() + (slice * rows_ + p.row) * columns_ + p.column;
    const Vertex* upper = lower + columns_;
    const double cells = static_cast<double>((rows_ - 1) * (columns_ - 1));
    return cells * scale_[slice] *
           lerp(p.b, lerp(p.a, lower[0].density, lower[1].density),
                lerp(p.a, upper[0].density, upper[1].density));
}

VisibleNormals::View VisibleNormals::view() const {
    static_assert(sizeof(Vertex) == 2 * sizeof(float) && sizeof(RowSum) == 2 * sizeof(float));
    return {&vertices_.data()->density, &rowSums_.data()->whole, scale_.data(), rows_, columns_};
}

std::vector<float> VisibleNormals::densities() const {
    std::vector<float> values(vertices_.size());
    std::ranges::transform(vertices_, values.begin(), &Vertex::density);
    return values;
}

namespace {

// `count` channels from `first` on; a constant for RGB, so that the loops unroll.
template <std::size_t most>
void interpolateChannels(const Spectra& spectra, const GridPosition& p, const Slices& slices,
                         double factor, std::size_t first, std::size_t count, double* out,
                         std::size_t stride) {
    const std::size_t n = spectra.channels;
    const double weights[4] = {(1 - p.a) * (1 - p.b), p.a * (1 - p.b), (1 - p.a) * p.b, p.a * p.b};
    const std::size_t offsets[4] = {0, n, spectra.columns * n, (spectra.columns + 1) * n};
    std::array<double, most> sum{};
    for (int i = 0; i < slices.count; ++i) {
        const float* corner =
            spectra.values.data() +
            ((slices.index[i] * spectra.rows + p.row) * spectra.columns + p.column) * n + first;
        for (int k = 0; k < 4; ++k) {
            const double weight = slices.weight[i] * weights[k];
            const float* from = corner + offsets[k];
            for (std::size_t c = 0; c < count; ++c) sum[c] += weight * from[c];
        }
    }
    for (std::size_t c = 0; c < count; ++c) {
        out[(first + c) * stride] = std::max(sum[c] * factor, 0.0);
    }
}

}  // namespace

void Spectra::at(VisibleNormals::Point point, const Slices& slices, double factor, double* out,
                 std::size_t stride) const {
    const GridPosition p(point.x, point.y, columns, rows);
    if (channels == 3) {
        interpolateChannels<3>(*this, p, slices, factor, 0, 3, out, stride);
        return;
    }
    constexpr std::size_t chunk = 32;
    for (std::size_t first = 0; first < channels; first += chunk) {
        interpolateChannels<chunk>(*this, p, slices, factor, first,
                                   std::min(chunk, channels - first), out, stride);
    }
}

}  // namespace hshfit::brdfs
