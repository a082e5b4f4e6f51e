#include <hshfit/light/latlong_projection.h>

#include <hshfit/bases/sh.h>
#include <hshfit/light/internal/picture_spectra.h>
#include <hshfit/projection/lane_products.h>
#include <hshfit/stop_request.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

namespace hshfit::inline light {
namespace {

constexpr std::size_t rowsOfBlock = 64, rowsOfTask = 8, degreesOfTask = 32;
/// Values in the spectra of all rows, where they are kept.
constexpr std::size_t mostKept = std::size_t{1} << 26;

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
                              const std::vector<double>& fourier, const SpectrumColumns& columns) {
    const std::size_t count = rings.count(), all = columns.all;
    const std::size_t cosine = columns.of(static_cast<std::size_t>(m), false), sine = cosine + 1;
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

struct LatlongProjection::Plans {
    SpectrumColumns columns;
    std::optional<ShortPlan> low;
    std::optional<FourierPlan> azimuth, colatitude;

    Plans(int order, std::size_t width, std::size_t height, bool whole) : columns(order) {
        if (ShortPlan::serves(order, width))
            low.emplace(order, width);
        else
            azimuth.emplace(width);
        if (whole) colatitude.emplace(height);
    }
};

LatlongProjection::LatlongProjection(int order, std::size_t width, std::size_t height)
    : order_(order), width_(width), height_(height) {
    const std::size_t row = 3 * SpectrumColumns(order).all;
    const auto degrees = static_cast<std::size_t>(order) + 1;
    whole_ = order > ShortPlan::mostOrder && 2 * degrees <= height && row * height <= mostKept;
    plans_ = std::make_unique<const Plans>(order, width, height, whole_);
    waves_ = wavesOf(height);
    spectra_.resize((whole_ ? height : rowsOfBlock) * row);
    fourier_.assign(degrees * row, 0.0);
}
LatlongProjection::~LatlongProjection() = default;

double LatlongProjection::stepWeight(std::size_t j) const {
    const double half = pi / 2 / static_cast<double>(height_);
    return 2 / pi *
           (j == 0 ? half : 2 * std::sin(static_cast<double>(j) * half) / static_cast<double>(j));
}

void LatlongProjection::addRows(const float* rows, std::size_t count) {
    assert(rows_ + count <= height_);
    for (std::size_t first = 0; first < count; first += rowsOfBlock) {
        const std::size_t some = std::min(rowsOfBlock, count - first);
        double* const spectra =
            spectra_.data() + (whole_ ? rows_ * 3 * plans_->columns.all : std::size_t{0});
        addBlock(rows + first * 3 * width_, some, spectra);
        if (!whole_) addFourierSums(spectra, some);
        rows_ += some;
    }
    if (whole_ && rows_ == height_) transformRows();
}

void LatlongProjection::addBlock(const float* rows, std::size_t count, double* spectra) {
    stopIfRequested();
    const SpectrumColumns& columns = plans_->columns;
    std::array<std::array<double, 3>, rowsOfBlock> squares;
    tbb::parallel_for(std::size_t{0}, (count + rowsOfTask - 1) / rowsOfTask, [&](std::size_t task) {
        const std::size_t first = task * rowsOfTask, some = std::min(rowsOfTask, count - first);
        const float* const from = rows + first * 3 * width_;
        double* const out = spectra + first * 3 * columns.all;
        if (plans_->low)
            pictureSpectra(*plans_->low, columns, from, some, out, squares[first].data());
        else
            pictureSpectra(*plans_->azimuth, columns, from, some, out, squares[first].data());
    });
    const double step = 2 * pi / static_cast<double>(width_);
    for (std::size_t r = 0; r < count; ++r) {
        const double middle = waves_[(2 * (rows_ + r) + 1 + 3 * height_) % (4 * height_)];  // sine
        const double solidAngle =
            2 * middle * std::sin(pi / 2 / static_cast<double>(height_)) * step;
        for (std::size_t c = 0; c < 3; ++c) energy_[c] += solidAngle * squares[r][c];
    }
}

void LatlongProjection::addFourierSums(const double* spectra, std::size_t count) {
    const SpectrumColumns& columns = plans_->columns;
    const std::size_t all = columns.all, degrees = static_cast<std::size_t>(order_) + 1;
    const std::size_t period = 4 * height_;
    tbb::parallel_for(
        std::size_t{0}, (degrees + degreesOfTask - 1) / degreesOfTask, [&](std::size_t task) {
            const std::size_t first = task * degreesOfTask;
            const std::size_t some = std::min(degreesOfTask, degrees - first);
            std::vector<double> steps(some * count);  // [degree][row]
            for (const bool sine : {false, true}) {
                for (std::size_t j = 0; j < some; ++j) {
                    const double weight = stepWeight(first + j);
                    const std::size_t step = 2 * (first + j) % period;
                    std::size_t at =
                        ((first + j) * (2 * rows_ + 1) + (sine ? 3 * height_ : 0)) % period;
                    for (std::size_t r = 0; r < count; ++r) {
                        steps[j * count + r] = weight * waves_[at];
                        at += step;
                        if (at >= period) at -= period;
                    }
                }
                const std::size_t begin = sine ? 0 : columns.evens;
                const std::size_t end = sine ? columns.evens : all;
                for (std::size_t c = 0; c < 3 && begin < end; ++c) {
                    const std::size_t column = c * all + begin;
                    addProducts({steps.data(), some, count},
                                {spectra + column, end - begin, 3 * all}, count,
                                fourier_.data() + first * 3 * all + column, 3 * all);
                }
            }
        });
}

void LatlongProjection::transformRows() {
    const SpectrumColumns& columns = plans_->columns;
    constexpr std::size_t group = SpectrumColumns::group;
    const auto degrees = static_cast<std::size_t>(order_) + 1;
    std::vector<double> weights;
    for (std::size_t j = 0; j < degrees; ++j) weights.push_back(stepWeight(j));
    tbb::parallel_for(std::size_t{0}, 3 * columns.all / group, [&](std::size_t k) {
        const std::size_t column = k * group;
        colatitudeSums(*plans_->colatitude, column % columns.all < columns.evens,
                       spectra_.data() + column, 3 * columns.all, degrees, weights.data(),
                       fourier_.data() + column);
    });
    spectra_ = {};
}

void LatlongProjection::coefficients(double turn, double* out) const {
    assert(rows_ == height_);
    const auto harmonics = bases::makeSh(order_, {});
    const Rings rings(order_);
    const auto slots = static_cast<std::size_t>(harmonics->slots());
    const double step = 2 * pi / static_cast<double>(width_);
    tbb::parallel_for(0, order_, [&](int m) {
        stopIfRequested();
        const std::vector<double> sums = thetaSums(*harmonics, rings, m, fourier_, plans_->columns);
        const double width =
            (m == 0 ? step : 2 * std::sin(m * step / 2) / m) / std::sqrt(m == 0 ? 2 * pi : pi);
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
