#include <hshfit/bases/basis.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace hshfit::bases {
namespace {

constexpr std::size_t blockSize = 32;

/// The cosine and sine of the azimuth; (1, 0) at the pole.
void azimuthCosSin(double x, double y, double& c, double& s) {
    const double radius = std::hypot(x, y);
    c = radius > 0 ? x / radius : 1;
    s = radius > 0 ? y / radius : 0;
}

/// az_m for |m| < order to out[(order - 1 + m) * stride], by powers of c + i s.
template <class Real>
void azimuthRow(Real c, Real s, int order, bool condonShortley, std::size_t stride, Real* out) {
    const auto slot = [&](int m) -> Real& {
        return out[static_cast<std::size_t>(order - 1 + m) * stride];
    };
    slot(0) = static_cast<Real>(1 / std::sqrt(2 * pi));
    const auto scale = static_cast<Real>(1 / std::sqrt(pi));
    Real re = 1, im = 0;
    for (int m = 1; m < order; ++m) {
        const Real next = re * c - im * s;
        im = re * s + im * c;
        re = next;
        const Real sign = condonShortley && m % 2 == 1 ? -scale : scale;
        slot(m) = sign * re;
        slot(-m) = sign * im;
    }
}

/// The memory of a thread for a block. It is kept, so that later calls allocate nothing.
template <class Real>
struct ThetaBlock {
    std::vector<Elevation<Real>> points;
    std::vector<Real> azimuths, parts;

    static ThetaBlock& ofThread(int order, std::size_t count) {
        static thread_local ThetaBlock block;
        block.points.resize(count);
        block.azimuths.resize(static_cast<std::size_t>(2 * order - 1) * count);
        block.parts.resize(static_cast<std::size_t>(order) * count);
        return block;
    }
};

/// Block by block: theta parts of all points for one m, times their azimuth parts.
template <class Real>
void tabulateByTheta(const Basis& basis, DirectionBatch directions, Basis::Layout layout,
                     Real* out) {
    const int order = basis.order();
    const bool bySlot = layout == Basis::Layout::bySlot;
    const std::size_t slotStep = bySlot ? directions.count : 1;
    const std::size_t step = bySlot ? 1 : static_cast<std::size_t>(basis.slots());
    auto& [points, azimuths, parts] =
        ThetaBlock<Real>::ofThread(order, std::min(blockSize, directions.count));
    for (std::size_t first = 0; first < directions.count; first += blockSize) {
        const std::size_t n = std::min(blockSize, directions.count - first);
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t i = first + k;
            const Direction d{directions.x[i], directions.y[i], directions.z[i]};
            const Elevation<double> e = elevationOf(d);
            points[k] = {static_cast<Real>(e.mu), static_cast<Real>(e.oneMinusMu)};
            double c = 1, s = 0;
            azimuthCosSin(d.x, d.y, c, s);
            azimuthRow(static_cast<Real>(c), static_cast<Real>(s), order, basis.condonShortley(), n,
                       azimuths.data() + k);
        }
        for (int m = 0; m < order; ++m) {
            basis.theta(m, std::span(points).first(n), parts.data());
            const Real* plus = azimuths.data() + static_cast<std::size_t>(order - 1 + m) * n;
            const Real* minus = azimuths.data() + static_cast<std::size_t>(order - 1 - m) * n;
            for (int l = m; l < order; ++l) {
                const Real* row = parts.data() + static_cast<std::size_t>(l - m) * n;
                Real* upper =
                    out + first * step + static_cast<std::size_t>(slotOf(l, m)) * slotStep;
                Real* lower =
                    out + first * step + static_cast<std::size_t>(slotOf(l, -m)) * slotStep;
                for (std::size_t k = 0; k < n; ++k) {
                    upper[k * step] = row[k] * plus[k];
                    lower[k * step] = row[k] * minus[k];
                }
            }
        }
    }
}

}  // namespace

double azimuthSign(int m, bool condonShortley) {
    return condonShortley && m % 2 != 0 ? -1 : 1;
}

void azimuthParts(const Direction& d, int order, bool condonShortley, double* out) {
    assert(order > 0);
    double c = 1, s = 0;
    azimuthCosSin(d.x, d.y, c, s);
    azimuthRow(c, s, order, condonShortley, 1, out);
}

bool Basis::has(int l, int m) const {
    return l >= 0 && l < order_ && std::abs(m) <= l;
}

int Basis::functionCount(int order) const {
    int count = 0;
    for (int l = 0; l < std::min(order, order_); ++l)
        for (int m = -l; m <= l; ++m) count += has(l, m);
    return count;
}

void Basis::analysisTheta(int m, std::span<const Elevation<double>> points, double* out) const {
    theta(m, points, out);
}

void Basis::coefficientsFromMoments(const double* moments, int order, double* out) const {
    assert(order <= order_);
    std::copy_n(moments, order * order, out);
}

double Basis::capturedEnergy(const double* moments, int order) const {
    assert(order <= order_);
    double sum = 0;
    for (int i = 0; i < order * order; ++i) sum += moments[i] * moments[i];
    return sum;
}

void Basis::tabulate(DirectionBatch directions, Layout layout, double* out) const {
    tabulateByTheta(*this, directions, layout, out);
}

void Basis::tabulate(DirectionBatch directions, Layout layout, float* out) const {
    tabulateByTheta(*this, directions, layout, out);
}

}  // namespace hshfit::bases
