#include <hshfit/rings.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace hshfit {
namespace {

/// Rings and azimuths evaluated together: 4096 points and their values stay in the caches.
constexpr std::size_t groupRings = 8, chunkAzimuths = 512;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct RingGroup {
    std::size_t first, rings, azimuths;
};

std::vector<RingGroup> groupsOf(const HemisphereGrid& grid) {
    std::vector<RingGroup> groups;
    for (const auto& panel : grid.panels) {
        for (std::size_t r = 0; r < panel.rings; r += groupRings) {
            groups.push_back(
                {panel.firstRing + r, std::min(groupRings, panel.rings - r), panel.azimuths});
        }
    }
    return groups;
}

/// az_m at `count` azimuths from number `first`, times the quadrature weight: columns m = 0 .. n-1
/// (cosines), then, unless even, m = 1 .. n-1 (sines). Powers of exp(i phi), error about m eps.
void fillTable(std::size_t first, std::size_t count, std::size_t azimuths, int order, bool even,
               Eigen::ArrayXd& cosine, Eigen::ArrayXd& sine, Eigen::MatrixXd& table) {
    cosine.resize(count);
    sine.resize(count);
    const double step = 2 * pi / static_cast<double>(azimuths);
    for (std::size_t j = 0; j < count; ++j) {
        const double phi = (static_cast<double>(first + j) + 0.5) * step;
        cosine[j] = std::cos(phi);
        sine[j] = std::sin(phi);
    }
    const double weight = even ? 2 * step : step;
    table.resize(count, even ? order : 2 * order - 1);
    table.col(0).setConstant(weight / std::sqrt(2 * pi));
    Eigen::ArrayXd re = Eigen::ArrayXd::Constant(count, weight / std::sqrt(pi));
    Eigen::ArrayXd im = Eigen::ArrayXd::Zero(count), next(count);
    for (int m = 1; m < order; ++m) {
        next = re * cosine - im * sine;
        im = re * sine + im * cosine;
        re = next;
        table.col(m) = re;
        if (!even) table.col(order - 1 + m) = im;
    }
}

/// The buffers of one task.
struct Workspace {
    std::vector<double> x, y, z;
    RowMatrix values;  ///< [channel * rings + ring][azimuth]
    Eigen::ArrayXd cosine, sine;
    Eigen::MatrixXd table, spectrum;
};

class Sampler {
public:
    Sampler(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid, Quantity quantity,
            bool even, RingSpectrum& result)
        : brdf_(brdf), wo_(wo), grid_(grid), quantity_(quantity), even_(even), result_(result) {}

    void operator()(const RingGroup& group) const {
        Workspace w;
        const std::size_t channels = result_.channels;
        const std::size_t azimuths = even_ ? group.azimuths / 2 : group.azimuths;
        const double weight = (even_ ? 4 : 2) * pi / static_cast<double>(group.azimuths);
        w.spectrum.setZero(channels * group.rings, even_ ? result_.order : 2 * result_.order - 1);
        Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(channels * group.rings);
        for (std::size_t first = 0; first < azimuths; first += chunkAzimuths) {
            const std::size_t count = std::min(chunkAzimuths, azimuths - first);
            fillTable(first, count, group.azimuths, result_.order, even_, w.cosine, w.sine,
                      w.table);
            evaluate(group, count, w);
            w.spectrum.noalias() += w.values * w.table;
            squares += weight * w.values.rowwise().squaredNorm().array();
        }
        store(group, w.spectrum, squares);
    }

private:
    void evaluate(const RingGroup& group, std::size_t count, Workspace& w) const {
        const std::size_t points = group.rings * count;
        w.x.resize(points);
        w.y.resize(points);
        w.z.resize(points);
        for (std::size_t r = 0, k = 0; r < group.rings; ++r) {
            const double s = grid_.sines[group.first + r],
                         mu = grid_.elevations[group.first + r].mu;
            for (std::size_t j = 0; j < count; ++j, ++k) {
                w.x[k] = s * w.cosine[j];
                w.y[k] = s * w.sine[j];
                w.z[k] = mu;
            }
        }
        w.values.resize(result_.channels * group.rings, count);
        brdf_.eval(wo_, {w.x.data(), w.y.data(), w.z.data(), points}, w.values.data());
        if (quantity_ == Quantity::brdfCosine) {
            for (Eigen::Index row = 0; row < w.values.rows(); ++row) {
                w.values.row(row) *= grid_.elevations[group.first + row % group.rings].mu;
            }
        }
        if (!w.values.allFinite()) reportNonFinite(w);
    }

    [[noreturn]] void reportNonFinite(const Workspace& w) const {
        brdf_.checkIntact();  // bad data has its own, more exact message
        const std::size_t points = w.x.size();
        std::size_t k = 0;
        while (std::isfinite(w.values.data()[k])) ++k;
        k %= points;
        const Direction wi{w.x[k], w.y[k], w.z[k]};
        throw NumericError(fmt::format(
            "{}: not finite at theta_i = {:.9g}, phi_i = {:.9g}, theta_o = {:.9g}, phi_o = {:.9g} "
            "degrees",
            brdf_.name(), degrees(polarAngle(wi)), degrees(azimuth(wi)), degrees(polarAngle(wo_)),
            degrees(azimuth(wo_))));
    }

    void store(const RingGroup& group, const Eigen::MatrixXd& spectrum,
               const Eigen::ArrayXd& squares) const {
        const int n = result_.order;
        for (std::size_t c = 0; c < result_.channels; ++c) {
            for (std::size_t r = 0; r < group.rings; ++r) {
                const Eigen::Index row = c * group.rings + r;
                const std::size_t ring = group.first + r;
                for (int m = 0; m < n; ++m) result_.part(m, c)[ring] = spectrum(row, m);
                for (int m = 1; m < n && !even_; ++m) {
                    result_.part(-m, c)[ring] = spectrum(row, n - 1 + m);
                }
                result_.squares[ring] += squares[row];
            }
        }
    }

    const Brdf& brdf_;
    const Direction& wo_;
    const HemisphereGrid& grid_;
    Quantity quantity_;
    bool even_;
    RingSpectrum& result_;
};

}  // namespace

RingSpectrum sampleRings(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid,
                         Quantity quantity, int order, bool even) {
    RingSpectrum result;
    result.order = order;
    result.channels = brdf.channels().count();
    result.rings = grid.weights.size();
    result.evaluations = grid.points() / (even ? 2 : 1);
    result.parts.assign((2 * order - 1) * result.channels * result.rings, 0.0);
    result.squares.assign(result.rings, 0.0);

    const std::vector<RingGroup> groups = groupsOf(grid);
    const Sampler sampler(brdf, wo, grid, quantity, even, result);
    tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) { sampler(groups[g]); });
    return result;
}

}  // namespace hshfit
