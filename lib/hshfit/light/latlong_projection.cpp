#include <hshfit/light/latlong_projection.h>

#include <hshfit/bases/sh.h>
#include <hshfit/light/internal/picture_rows.h>
#include <hshfit/projection/lane_products.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr std::size_t rowsOfBlock = 64, rowsOfTask = 4, degreesOfTask = 32;

/// The place of one kind of azimuth functions among the columns.
struct Kind {
    std::size_t first, count;
    bool evenM;
};
std::array<Kind, 4> kindsOf(const AzimuthColumns& columns) {
    const std::size_t c1 = columns.c0, s1 = c1 + columns.c1, s0 = s1 + columns.s1;
    return {{{0, columns.c0, true},
             {c1, columns.c1, false},
             {s1, columns.s1, false},
             {s0, columns.s0, true}}};
}

/// Equispaced theta of the northern half, and at each the waves of the degrees of one parity,
/// times the weight of the point and its mirror image.
class Rings {
public:
    explicit Rings(int order) : degrees_(static_cast<std::size_t>(order)) {
        const std::size_t all = (static_cast<std::size_t>(order) + 2) / 2 * 2;
        count_ = all / 2;
        for (std::size_t k = 0; k < count_; ++k) {
            const double theta = (static_cast<double>(k) + 0.5) * pi / static_cast<double>(all);
            const double half = std::sin(theta / 2);
            elevations_.push_back({std::cos(theta), 2 * half * half});
        }
        for (const bool sine : {false, true}) {
            for (const std::size_t parity : {0, 1}) {
                std::vector<double>& to = waves_[sine][parity];
                for (std::size_t k = 0; k < count_; ++k) {
                    const double theta =
                        (static_cast<double>(k) + 0.5) * pi / static_cast<double>(all);
                    const double weight = 2 * pi / static_cast<double>(all) * std::sin(theta);
                    for (std::size_t j = parity; j <= degrees_; j += 2) {
                        // The angle is reduced in integers: j (2k + 1) of 4 all.
                        const double angle = static_cast<double>(j * (2 * k + 1) % (4 * all)) * pi /
                                             static_cast<double>(2 * all);
                        to.push_back(weight * (sine ? std::sin(angle) : std::cos(angle)));
                    }
                }
            }
        }
    }
    std::size_t count() const { return count_; }
    const std::vector<Elevation<double>>& elevations() const { return elevations_; }
    std::size_t degreesOf(std::size_t parity) const { return (degrees_ - parity) / 2 + 1; }
    /// [ring][degree of that parity]
    const double* waves(bool sine, std::size_t parity) const { return waves_[sine][parity].data(); }

private:
    std::size_t degrees_, count_;
    std::vector<Elevation<double>> elevations_;
    std::array<std::array<std::vector<double>, 2>, 2> waves_;
};

constexpr std::size_t sides = 8;  ///< cosine R, G, B, 0, sine R, G, B, 0

/// Sums over theta for one m: [l - m][side].
std::vector<double> thetaSums(const Basis& harmonics, const Rings& rings, int m,
                              const std::vector<double>& fourier, std::size_t all,
                              std::size_t cosine, std::size_t sine) {
    const std::size_t count = rings.count();
    const auto degrees = static_cast<std::size_t>(harmonics.order() - m);
    std::vector<double> theta(degrees * count), out(degrees * sides, 0.0);
    harmonics.theta(m, rings.elevations(), theta.data());
    const bool evenM = m % 2 == 0;
    for (const std::size_t parity : {0, 1}) {
        const std::size_t waves = rings.degreesOf(parity);
        std::vector<double> sums(waves * sides, 0.0), values(count * sides, 0.0);
        for (std::size_t j = 0; j < waves; ++j) {
            const double* from = fourier.data() + (2 * j + parity) * 3 * all;
            for (std::size_t c = 0; c < 3; ++c) {
                sums[j * sides + c] = from[c * all + cosine];
                if (m > 0) sums[j * sides + 4 + c] = from[c * all + sine];
            }
        }
        addProducts({rings.waves(evenM, parity), count, waves}, {sums.data(), sides, sides}, waves,
                    values.data(), sides);
        // Even about the equator: cosines of even degree, sines of odd degree.
        const std::size_t first = evenM ? 1 - parity : parity;
        if (first >= degrees) continue;
        addProducts({theta.data() + first * count, (degrees - first + 1) / 2, 2 * count},
                    {values.data(), sides, sides}, count, out.data() + first * sides, 2 * sides);
    }
    return out;
}

}  // namespace

LatlongProjection::LatlongProjection(int order, std::size_t width, std::size_t height)
    : order_(order),
      width_(width),
      height_(height),
      repeats_(width % 4 == 0   ? 1
               : width % 2 == 0 ? 2
                                : 4),
      columns_(order) {
    const std::size_t azimuths = width_ * repeats_;
    table_.fill(order, {azimuths}, 0, azimuths / 4);
    for (std::size_t k = 0; k < 4 * height_; ++k) {
        waves_.push_back(std::cos(static_cast<double>(k) * pi / static_cast<double>(2 * height_)));
    }
    spectrum_.resize(rowsOfBlock * 3 * columns_.all());
    fourier_.assign((static_cast<std::size_t>(order) + 1) * 3 * columns_.all(), 0.0);
}

double LatlongProjection::wave(std::size_t k, bool sine) const {
    return waves_[(k + (sine ? 3 * height_ : 0)) % (4 * height_)];
}

void LatlongProjection::addRows(const float* rows, std::size_t count) {
    assert(rows_ + count <= height_);
    for (std::size_t first = 0; first < count; first += rowsOfBlock) {
        const std::size_t some = std::min(rowsOfBlock, count - first);
        addBlock(rows + first * 3 * width_, some);
        addFourierSums(some);
        rows_ += some;
    }
}

void LatlongProjection::addBlock(const float* rows, std::size_t count) {
    const std::size_t all = columns_.all(), quadrant = table_.count;
    const std::size_t kindStride = rowsOfTask * 3 * quadrant;
    std::vector<std::array<double, 3>> squares(count);
    tbb::parallel_for(std::size_t{0}, (count + rowsOfTask - 1) / rowsOfTask, [&](std::size_t task) {
        const std::size_t first = task * rowsOfTask, some = std::min(rowsOfTask, count - first);
        // Kept between tasks: fresh pages for each would cost as much as the sums of low orders.
        thread_local std::vector<double> folded;
        thread_local std::vector<float> repeated;
        if (folded.size() < 4 * kindStride) folded.resize(4 * kindStride);
        for (std::size_t r = 0; r < some; ++r) {
            const float* row = rows + (first + r) * 3 * width_;
            if (repeats_ > 1) {
                repeated.clear();
                for (std::size_t column = 0; column < width_; ++column)
                    for (std::size_t k = 0; k < repeats_; ++k)
                        repeated.insert(repeated.end(), row + 3 * column, row + 3 * column + 3);
                row = repeated.data();
            }
            foldPictureRow(row, width_ * repeats_, kindStride, folded.data() + r * 3 * quadrant,
                           squares[first + r].data());
        }
        double* out = spectrum_.data() + first * 3 * all;
        std::fill(out, out + some * 3 * all, 0.0);
        const double* from = folded.data();
        for (const Kind& kind : kindsOf(columns_)) {
            addProducts({from, some * 3, quadrant},
                        {table_.rows.data() + kind.first, kind.count, all}, quadrant,
                        out + kind.first, all);
            from += kindStride;
        }
    });
    const double step = 2 * pi / static_cast<double>(width_ * repeats_);
    for (std::size_t r = 0; r < count; ++r) {
        const double middle = wave(2 * (rows_ + r) + 1, true);
        const double solidAngle =
            2 * middle * std::sin(pi / 2 / static_cast<double>(height_)) * step;
        for (std::size_t c = 0; c < 3; ++c) energy_[c] += solidAngle * squares[r][c];
    }
}

void LatlongProjection::addFourierSums(std::size_t count) {
    const std::size_t all = columns_.all(), degrees = static_cast<std::size_t>(order_) + 1;
    tbb::parallel_for(
        std::size_t{0}, (degrees + degreesOfTask - 1) / degreesOfTask, [&](std::size_t task) {
            const std::size_t first = task * degreesOfTask;
            const std::size_t some = std::min(degreesOfTask, degrees - first);
            std::array<std::vector<double>, 2> steps;  // by cosine, sine: [degree][row]
            for (const bool sine : {false, true}) {
                for (std::size_t j = first; j < first + some; ++j) {
                    const double half = pi / 2 / static_cast<double>(height_);
                    const double width = j == 0 ? half
                                                : 2 * std::sin(static_cast<double>(j) * half) /
                                                      static_cast<double>(j);
                    for (std::size_t r = 0; r < count; ++r) {
                        steps[sine].push_back(2 / pi * width *
                                              wave(j * (2 * (rows_ + r) + 1), sine));
                    }
                }
            }
            for (const Kind& kind : kindsOf(columns_)) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::size_t column = c * all + kind.first;
                    addProducts({steps[kind.evenM].data(), some, count},
                                {spectrum_.data() + column, kind.count, 3 * all}, count,
                                fourier_.data() + first * 3 * all + column, 3 * all);
                }
            }
        });
}

void LatlongProjection::coefficients(double turn, double* out) const {
    assert(rows_ == height_);
    const auto harmonics = bases::makeSh(order_, {});
    const Rings rings(order_);
    const auto slots = static_cast<std::size_t>(harmonics->slots());
    const double step = 2 * pi / static_cast<double>(width_ * repeats_);
    tbb::parallel_for(0, order_, [&](int m) {
        const std::vector<double> sums = thetaSums(*harmonics, rings, m, fourier_, columns_.all(),
                                                   columns_.of(m), m == 0 ? 0 : columns_.of(-m));
        const double width = m == 0 ? step : 2 * std::sin(m * step / 2) / m;
        // phi = pi + turn - psi
        const double cosine = std::cos(m * turn) * (m % 2 == 0 ? 1 : -1) * width;
        const double sine = std::sin(m * turn) * (m % 2 == 0 ? 1 : -1) * width;
        for (int l = m; l < order_; ++l) {
            const double* row = sums.data() + static_cast<std::size_t>(l - m) * sides;
            for (std::size_t c = 0; c < 3; ++c) {
                double* to = out + c * slots;
                to[slotOf(l, m)] = cosine * row[c] + sine * row[4 + c];
                if (m > 0) to[slotOf(l, -m)] = sine * row[c] - cosine * row[4 + c];
            }
        }
    });
}

}  // namespace hshfit::inline light
