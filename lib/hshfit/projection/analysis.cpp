#include <hshfit/projection/analysis.h>

#include <hshfit/error.h>
#include <hshfit/projection/internal/ring_kernels.h>
#include <hshfit/projection/lane_products.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline projection {
namespace {

constexpr std::size_t lanes = lanesOfFunctions;

}  // namespace

AnalysisGrid AnalysisGrid::gauss(std::size_t rings, std::size_t azimuths, bool sphere) {
    if (azimuths == 0 || azimuths % 4 != 0) {
        throw UsageError(
            fmt::format("{} azimuths for an analysis; they have to be a multiple of 4", azimuths));
    }
    AnalysisGrid grid;
    grid.azimuths = azimuths;
    const GaussRule& rule = gaussLegendre(static_cast<int>(rings));
    for (std::size_t r = 0; r < rings; ++r) {
        // The other end of the rule is 1 - x without cancellation.
        const double x = rule.nodes[r], below = 1 + rule.nodes[rings - 1 - r];
        grid.elevations.push_back(sphere ? Elevation<double>{x, below}
                                         : Elevation<double>{(1 + x) / 2, below / 2});
        grid.weights.push_back(sphere ? rule.weights[r] : rule.weights[r] / 2);
    }
    return grid;
}

struct Analysis::Workspace {
    std::vector<double> ring, mirror;        ///< [azimuth][function]
    std::vector<double> folded, difference;  ///< [kind][azimuth of the quadrant][function]
    std::vector<double> spectrum;            ///< [column][parity][ring][function]
    std::vector<double> products;            ///< [l][function]
    std::vector<double> moments;             ///< [slot][function]
};

Analysis::Analysis(const Basis& basis, AnalysisGrid grid)
    : order_(basis.order()),
      slots_(static_cast<std::size_t>(basis.slots())),
      grid_(std::move(grid)),
      columns_(order_, 1) {
    const std::size_t rings = grid_.weights.size();
    std::vector<double> whole;  // for each m: [l - m][ring]
    for (int m = 0; m < order_; ++m) {
        const std::size_t begin = whole.size();
        whole.resize(begin + static_cast<std::size_t>(order_ - m) * rings);
        basis.analysisTheta(m, grid_.elevations, whole.data() + begin);
    }
    folded_ = findParity(whole);
    half_ = folded_ ? (rings + 1) / 2 : rings;
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    const double step = 2 * pi / static_cast<double>(grid_.azimuths);
    const double* from = whole.data();
    for (int m = 0; m < order_; ++m) {
        const double sign = azimuthSign(m, basis.condonShortley());
        for (int parity : {0, 1}) {
            first_.push_back(theta_.size());
            if (parity == 1 && !folded_) continue;
            for (int l = m + parity; l < order_; l += folded_ ? 2 : 1) {
                const double* row = from + static_cast<std::size_t>(l - m) * rings;
                for (std::size_t r = 0; r < half_; ++r) {
                    const double mu = projected ? grid_.elevations[r].mu : 1.0;
                    theta_.push_back(row[r] * grid_.weights[r] * step * mu * sign);
                }
            }
        }
        from += static_cast<std::size_t>(order_ - m) * rings;
    }
    for (int m = 1 - order_; m < order_; ++m)
        for (int parity = 0; parity < (folded_ ? 2 : 1); ++parity)
            for (int l = std::abs(m) + parity; l < order_; l += folded_ ? 2 : 1)
                slotOfRow_.push_back(static_cast<std::size_t>(slotOf(l, m)));
    AzimuthTable table;
    table.fill(order_, {grid_.azimuths}, 0, grid_.azimuths / 4);
    const AzimuthColumns grouped(order_);
    azimuths_.resize(columns_.all() * table.count);
    for (int m = 1 - order_; m < order_; ++m)
        for (std::size_t j = 0; j < table.count; ++j)
            azimuths_[columns_.of(m) * table.count + j] =
                table.rows[j * grouped.all() + grouped.of(m)];
}

bool Analysis::findParity(const std::vector<double>& whole) const {
    const std::size_t rings = grid_.weights.size();
    double largest = 0, worst = 0;
    std::size_t row = 0;
    for (int m = 0; m < order_; ++m) {
        for (int l = m; l < order_; ++l, ++row) {
            const double sign = (l - m) % 2 == 0 ? 1 : -1;
            for (std::size_t r = 0; r < rings; ++r) {
                const double here = whole[row * rings + r];
                const double there = whole[row * rings + rings - 1 - r];
                largest = std::max(largest, std::abs(here));
                worst = std::max(worst, std::abs(here - sign * there));
            }
        }
    }
    for (std::size_t r = 0; r < rings; ++r)
        worst = std::max(worst, std::abs(grid_.weights[r] - grid_.weights[rings - 1 - r]));
    // Tolerance of rounding, which grows with the order.
    return worst <= 1e-14 * order_ * largest;
}

void Analysis::run(const double* samples, std::size_t functions, double* out) const {
    Workspace w;
    for (std::size_t f = 0; f < functions; f += lanes) {
        block(samples + f * grid_.points(), std::min(lanes, functions - f), out + f * slots_, w);
    }
}

void Analysis::block(const double* samples, std::size_t functions, double* out,
                     Workspace& w) const {
    const std::size_t sides = folded_ ? 2 : 1;
    w.spectrum.assign(columns_.all() * sides * half_ * lanes, 0.0);
    for (std::size_t r = 0; r < half_; ++r) ringSums(samples, functions, r, w);
    w.moments.assign(slots_ * lanes, 0.0);
    double* to = w.moments.data();
    for (int m = 1 - order_; m < order_; ++m) to = thetaSums(m, w, to);
    for (std::size_t k = 0; k < slots_; ++k) {
        for (std::size_t f = 0; f < functions; ++f)
            out[f * slots_ + slotOfRow_[k]] = w.moments[k * lanes + f];
    }
}

void Analysis::ringSums(const double* samples, std::size_t functions, std::size_t r,
                        Workspace& w) const {
    const std::size_t azimuths = grid_.azimuths, quadrant = azimuths / 4;
    const std::size_t opposite = grid_.weights.size() - 1 - r, values = azimuths * lanes;
    w.ring.resize(values);
    w.folded.resize(values);
    const auto interleave = [&](std::size_t ring, std::size_t nextRing, double* to) {
        const double* next = r + 1 < half_ ? samples + nextRing * azimuths : nullptr;
        interleaveFunctions(samples + ring * azimuths, functions, grid_.points(), azimuths, next,
                            to);
    };
    interleave(r, r + 1, w.ring.data());
    // The middle ring is its own partner: once among the even, never among the odd.
    const bool paired = folded_ && opposite != r;
    if (paired) {
        w.mirror.resize(values);
        w.difference.resize(values);
        interleave(opposite, opposite - 1, w.mirror.data());
    }
    foldFunctions(w.ring.data(), paired ? w.mirror.data() : nullptr, azimuths, w.folded.data(),
                  w.difference.data());
    const std::size_t column = (folded_ ? 2 : 1) * half_ * lanes;
    for (std::size_t side = 0; side < (paired ? 2 : 1); ++side) {
        const double* from = side == 0 ? w.folded.data() : w.difference.data();
        double* to = w.spectrum.data() + (side * half_ + r) * lanes;
        const double* rows = azimuths_.data();
        for (const std::size_t kind : {columns_.c0, columns_.c1, columns_.s1, columns_.s0}) {
            addProducts({rows, kind, quadrant}, {from, lanes, lanes}, quadrant, to, column);
            rows += kind * quadrant;
            from += quadrant * lanes;
            to += kind * column;
        }
    }
}

double* Analysis::thetaSums(int m, const Workspace& w, double* out) const {
    const int absM = std::abs(m), sides = folded_ ? 2 : 1;
    const std::size_t side = half_ * lanes;
    const double* spectrum =
        w.spectrum.data() + columns_.of(m) * static_cast<std::size_t>(sides) * side;
    for (int parity = 0; parity < sides; ++parity, spectrum += side) {
        const auto rows = static_cast<std::size_t>((order_ - absM - parity + sides - 1) / sides);
        addProducts({theta_.data() + first_[2 * absM + parity], rows, half_},
                    {spectrum, lanes, lanes}, half_, out, lanes);
        out += rows * lanes;
    }
    return out;
}

}  // namespace hshfit::inline projection
