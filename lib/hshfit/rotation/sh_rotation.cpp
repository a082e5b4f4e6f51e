#include <hshfit/rotation/sh_rotation.h>

#include <hshfit/error.h>
#include <hshfit/rotation/internal/quarter_turns.h>
#include <hshfit/rotation/internal/short_bands.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace hshfit::inline rotation {
namespace {

/// t_m D of quarter_turns.h.
double sideOf(int m) {
    return (m / 2 % 2 == 0 ? 1 : -1) * (m == 0 ? std::numbers::sqrt2 / 2 : 1);
}

/// J of one band, from its rows.
double entryOf(const std::vector<double>& rows, int l, int m1, int m2) {
    int a = std::abs(m1), b = std::abs(m2);
    const bool sine1 = m1 < 0, sine2 = m2 < 0;
    // Functions with other parities in y and z do not meet.
    if ((sine1 != sine2) == ((a + b) % 2 == 0) || sine1 != ((l + b) % 2 != 0)) return 0;
    const double value = sideOf(a) * sideOf(b) *
                         rows[kernels::rowOffset(static_cast<std::size_t>(std::max(a, b))) +
                              static_cast<std::size_t>(std::min(a, b))];
    if (sine1 != sine2) return std::max(a, b) % 2 == 1 ? value : -value;
    return sine1 ? -value : value;
}

kernels::ShortTable shortTable(const kernels::QuarterTables& quarters) {
    std::vector<std::vector<double>> rows;
    for (int l = 0; l < kernels::shortBands; ++l) {
        rows.emplace_back(kernels::rowOffset(static_cast<std::size_t>(l) + 1));
        kernels::quarterRows(l, quarters.steps(l), rows.back().data());
    }
    return kernels::ShortTable([&](int l, int m1, int m2) {
        return entryOf(rows[static_cast<std::size_t>(l)], l, m1, m2);
    });
}

/// Rotations of functions with the sign (-1)^m equal rotations without it about axes turned by pi
/// about z.
std::vector<Rotation> turnedAxes(std::span<const Rotation> rotations) {
    std::vector<Rotation> result;
    for (const Rotation& r : rotations) {
        auto rows = r.matrix();
        for (const std::size_t i : {2u, 5u, 6u, 7u}) rows[i] = -rows[i];
        result.push_back(Rotation::fromMatrix(rows));
    }
    return result;
}

/// Cosines and sines of m times an angle, m < order.
struct Multiples {
    std::vector<double> cosine, sine;

    Multiples(int order, double c, double s) : cosine{1}, sine{0} {
        for (int m = 1; m < order; ++m) {
            // From the halves: errors grow like m, as the error of m times the angle does.
            const auto a = static_cast<std::size_t>(m / 2), b = static_cast<std::size_t>(m) - a;
            const bool one = m == 1;
            cosine.push_back(one ? c : cosine[a] * cosine[b] - sine[a] * sine[b]);
            sine.push_back(one ? s : sine[a] * cosine[b] + cosine[a] * sine[b]);
        }
    }
};

struct AngleMultiples {
    Multiples alpha, beta, gamma;

    AngleMultiples(int order, const Rotation::Turns& t)
        : alpha(order, t.cosAlpha, t.sinAlpha),
          beta(order, t.cosBeta, t.sinBeta),
          gamma(order, t.cosGamma, t.sinGamma) {}
};

/// Memory of one band at work: rows of S, and two vectors of cosines and sines.
struct Workspace {
    std::vector<double> rows, one, two;

    explicit Workspace(int l)
        : rows(kernels::rowOffset(static_cast<std::size_t>(l) + 1)),
          one(2 * kernels::padded(static_cast<std::size_t>(l) + 1)),
          two(one.size()) {}
};

/// in and out: slot (l, 0) of a vector.
void rotateBand(int l, const AngleMultiples& turns, Workspace& work, const double* in,
                double* out) {
    double *c = work.one.data(), *s = c + work.one.size() / 2;
    double *c2 = work.two.data(), *s2 = c2 + work.two.size() / 2;
    const double half = std::numbers::sqrt2 / 2;
    c[0] = half * in[0];
    s[0] = 0;
    for (int m = 1; m <= l; ++m) {
        const auto k = static_cast<std::size_t>(m);
        const double cosine = turns.gamma.cosine[k], sine = turns.gamma.sine[k], side = sideOf(m);
        c[m] = side * (cosine * in[m] - sine * in[-m]);
        s[m] = side * (sine * in[m] + cosine * in[-m]);
    }
    kernels::applyQuarter(l, work.rows.data(), c, c2);
    c2[0] *= 0.5;
    s2[0] = 0;
    for (int m = 1; m <= l; ++m) {
        const auto k = static_cast<std::size_t>(m);
        const double cosine = turns.beta.cosine[k], sine = turns.beta.sine[k];
        const double a = c2[m], b = s2[m];
        c2[m] = cosine * a + sine * b;
        s2[m] = cosine * b - sine * a;
    }
    kernels::applyQuarter(l, work.rows.data(), c2, c);
    out[0] = half * c[0];
    for (int m = 1; m <= l; ++m) {
        const auto k = static_cast<std::size_t>(m);
        const double cosine = turns.alpha.cosine[k], sine = turns.alpha.sine[k], side = sideOf(m);
        out[m] = side * (cosine * c[m] - sine * s[m]);
        out[-m] = side * (sine * c[m] + cosine * s[m]);
    }
}

}  // namespace

struct ShRotation::Tables {
    explicit Tables(int order)
        : quarters(std::max(order, kernels::shortBands)), small(shortTable(quarters)) {}
    kernels::QuarterTables quarters;
    kernels::ShortTable small;
};

ShRotation::ShRotation(int order, Options options) : order_(order), options_(options) {
    if (order < 1 || order > maxOrder)
        throw UsageError(
            fmt::format("rotation of spherical harmonics of order {}; the order has "
                        "to be 1 to {}",
                        order, maxOrder));
    tables_ = std::make_unique<const Tables>(order);
}
ShRotation::~ShRotation() = default;
ShRotation::ShRotation(ShRotation&&) noexcept = default;
ShRotation& ShRotation::operator=(ShRotation&&) noexcept = default;

void ShRotation::rotate(std::span<const Rotation> rotations, std::size_t channels, const double* in,
                        double* out) const {
    std::vector<Rotation> turned;
    if (options_.condonShortley) {
        turned = turnedAxes(rotations);
        rotations = turned;
    }
    const auto stride = static_cast<std::size_t>(order_) * static_cast<std::size_t>(order_);
    const std::size_t count = rotations.size() * channels;
    constexpr std::size_t block = 512;  // vectors; a whole number of lanes
    tbb::parallel_for(std::size_t{0}, (count + block - 1) / block, [&](std::size_t b) {
        // Whole rotations a block, so that vectors find theirs by division.
        const std::size_t first = rotations.size() * b / ((count + block - 1) / block);
        const std::size_t last = rotations.size() * (b + 1) / ((count + block - 1) / block);
        const std::size_t from = first * channels * stride;
        kernels::rotateShort(
            tables_->small,
            {rotations.subspan(first, last - first), channels, (last - first) * channels, stride,
             std::min(order_, kernels::shortBands), in + from, out + from});
    });
    if (order_ <= kernels::shortBands) return;
    std::vector<AngleMultiples> turns;
    for (const Rotation& r : rotations) turns.emplace_back(order_, r.turns());
    tbb::parallel_for(0, order_ - kernels::shortBands, [&](int i) {
        const int l = order_ - 1 - i;  // the largest first
        Workspace work(l);
        kernels::quarterRows(l, tables_->quarters.steps(l), work.rows.data());
        const auto centre = static_cast<std::size_t>(l) * static_cast<std::size_t>(l + 1);
        for (std::size_t k = 0; k < count; ++k)
            rotateBand(l, turns[k / channels], work, in + k * stride + centre,
                       out + k * stride + centre);
    });
}

std::vector<double> ShRotation::rotate(const Rotation& rotation, std::span<const double> c) const {
    const auto slots = static_cast<std::size_t>(order_) * static_cast<std::size_t>(order_);
    if (c.size() % slots != 0)
        throw UsageError(
            fmt::format("{} coefficients; a multiple of {} is needed, the number of "
                        "slots of order {}",
                        c.size(), slots, order_));
    std::vector<double> result(c.size());
    rotate(std::span(&rotation, 1), c.size() / slots, c.data(), result.data());
    return result;
}

}  // namespace hshfit::inline rotation
