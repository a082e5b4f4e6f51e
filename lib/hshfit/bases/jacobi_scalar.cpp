#include <hshfit/bases/jacobi.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace hshfit::bases {

namespace {

using Step = JacobiBasis::Step;

constexpr std::size_t scalarBlock = 64;

/// Inputs of the recurrence for one point.
struct Place {
    double base;    ///< F^2
    double weight;  ///< W
    double y;       ///< t minus the nearer end
    int side;       ///< 0: the end is 1; 1: it is -1
};

Place placeOf(const JacobiFamily& family, double mu, double oneMinusMu) {
    Place place{0, 1, 0, 0};
    if (family.argument == JacobiFamily::Argument::cosine) {
        place.side = mu < 0;
        place.y = mu < 0 ? 1 + mu : -oneMinusMu;
    } else {
        if (mu < 0) return {0, 0, 0, 0};
        const bool nearPole = oneMinusMu <= 0.5;
        const bool down = family.argument == JacobiFamily::Argument::shiftedDown;
        place.side = nearPole == down;
        place.y = 2 * (nearPole ? oneMinusMu : mu) * (place.side == 0 ? -1 : 1);
    }
    switch (family.factor) {
        case JacobiFamily::Factor::sine:
            place.base = oneMinusMu * (1 + mu);
            break;
        case JacobiFamily::Factor::hump:
            place.base = 4 * mu * oneMinusMu;
            break;
        case JacobiFamily::Factor::chord:
            place.base = oneMinusMu;
            break;
    }
    if (family.timesRootCosine) place.weight = std::sqrt(mu);
    return place;
}

/// x = mantissa 2^exponent, beyond the range of double.
struct Scaled {
    double mantissa;
    long exponent;

    void multiply(const Scaled& other) {
        int shift = 0;
        mantissa = std::frexp(mantissa * other.mantissa, &shift);
        exponent += other.exponent + shift;
    }
};

Scaled scaled(double x) {
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    return {mantissa, exponent};
}

/// start base^{m/2}, for base > 0.
Scaled scaledStart(double start, double base, int m) {
    Scaled result = scaled(start), square = scaled(base);
    if (m % 2 == 1) result.multiply(scaled(std::sqrt(base)));
    for (int n = m / 2; n > 0; n /= 2) {
        if (n % 2 == 1) result.multiply(square);
        square.multiply(square);
    }
    return result;
}

/// start[j] *= base[j]^{m/2}.
void multiplyPowers(std::size_t n, double* base, int m, double* start) {
    if (m % 2 == 1)
        for (std::size_t j = 0; j < n; ++j) start[j] *= std::sqrt(base[j]);
    for (int power = m / 2; power > 0; power /= 2) {
        if (power % 2 == 1)
            for (std::size_t j = 0; j < n; ++j) start[j] *= base[j];
        for (std::size_t j = 0; j < n; ++j) base[j] *= base[j];
    }
}

/// The destination of a recurrence's values: row k of column p is out[k * rowStep + p].
template <class Real>
struct Rows {
    Real* out;
    std::size_t rowStep;
    int count;
};

/// The points of a block that share a side, packed.
template <class Real>
struct Lanes {
    std::size_t n = 0;
    std::array<std::size_t, scalarBlock> index;
    std::array<Real, scalarBlock> y, p, d;

    void add(std::size_t point, Real distance, Real start) {
        index[n] = point;
        y[n] = distance;
        p[n] = start;
        d[n] = 0;
        ++n;
    }
};

template <class Real>
void run(Lanes<Real>& lanes, const Step* steps, const Rows<Real>& rows) {
    const std::size_t n = lanes.n;
    if (n == 0) return;
    const bool contiguous = lanes.index[n - 1] - lanes.index[0] == n - 1;
    for (int k = 0; k < rows.count; ++k) {
        Real* row = rows.out + static_cast<std::size_t>(k) * rows.rowStep;
        if (contiguous)
            std::copy_n(lanes.p.begin(), n, row + lanes.index[0]);
        else
            for (std::size_t j = 0; j < n; ++j) row[lanes.index[j]] = lanes.p[j];
        if (k + 1 == rows.count) break;
        const auto slope = static_cast<Real>(steps[k].slope);
        const auto ratio = static_cast<Real>(steps[k].ratio);
        const auto carry = static_cast<Real>(steps[k].carry);
        for (std::size_t j = 0; j < n; ++j) {
            lanes.d[j] = slope * lanes.y[j] * lanes.p[j] + carry * lanes.d[j];
            lanes.p[j] = ratio * lanes.p[j] + lanes.d[j];
        }
    }
}

template <class Real>
Real flushed(Real p, long exponent) {
    const auto clamped = static_cast<int>(std::max(exponent, -100000L));
    const Real value = std::ldexp(p, clamped);
    return std::abs(value) < std::numeric_limits<Real>::min() ? Real{0} : value;
}

/// One point whose start lies near or below the smallest number: p and d share an exponent.
template <class Real>
void runScaled(std::size_t point, const Scaled& start, Real y, const Step* steps,
               const Rows<Real>& rows) {
    constexpr int shift = std::numeric_limits<Real>::max_exponent / 2;
    const Real big = std::ldexp(Real{1}, shift);
    Real p = static_cast<Real>(start.mantissa), d = 0;
    long exponent = start.exponent;
    for (int k = 0; k < rows.count; ++k) {
        rows.out[static_cast<std::size_t>(k) * rows.rowStep + point] =
            exponent == 0 ? p : flushed(p, exponent);
        if (k + 1 == rows.count) break;
        d = static_cast<Real>(steps[k].slope) * y * p + static_cast<Real>(steps[k].carry) * d;
        p = static_cast<Real>(steps[k].ratio) * p + d;
        if (exponent == 0 || std::max(std::abs(p), std::abs(d)) < big) continue;
        exponent += shift;
        const int fold = exponent > -shift ? static_cast<int>(exponent) : 0;
        p = std::ldexp(p, fold - shift);
        d = std::ldexp(d, fold - shift);
        exponent -= fold;
    }
}

}  // namespace

template <class Real>
void JacobiBasis::fillScalar(int m, std::span<const Elevation<Real>> points, Real* out) const {
    assert(m >= 0 && m < order());
    constexpr Real tiny = std::numeric_limits<Real>::min() / std::numeric_limits<Real>::epsilon();
    const std::size_t count = points.size(), step = static_cast<std::size_t>(family_.bandStep);
    const double c = starts_[static_cast<std::size_t>(m)];
    const std::size_t offset = offsets_[static_cast<std::size_t>(m)];
    const Rows<Real> rows{out, count * step, functions(m)};
    for (std::size_t first = 0; first < count; first += scalarBlock) {
        const std::size_t n = std::min(scalarBlock, count - first);
        std::array<Place, scalarBlock> places;
        std::array<double, scalarBlock> base, start;
        for (std::size_t j = 0; j < n; ++j) {
            const Elevation<Real>& e = points[first + j];
            places[j] = placeOf(family_, double{e.mu}, double{e.oneMinusMu});
            base[j] = places[j].base;
            start[j] = c * places[j].weight;
        }
        multiplyPowers(n, base.data(), m, start.data());
        std::array<Lanes<Real>, 2> lanes;
        for (std::size_t j = 0; j < n; ++j) {
            const Place& place = places[j];
            const auto y = static_cast<Real>(place.y);
            const auto side = static_cast<std::size_t>(place.side);
            const bool vanishes = place.weight == 0 || (m > 0 && place.base == 0);
            if (start[j] >= double{tiny} || vanishes)
                lanes[side].add(first + j, y, static_cast<Real>(start[j]));
            else
                runScaled(first + j, scaledStart(c * place.weight, place.base, m), y,
                          steps_[side].data() + offset, rows);
        }
        for (const std::size_t side : {0u, 1u})
            run(lanes[side], steps_[side].data() + offset, rows);
    }
    const std::size_t period = family_.evenOnly ? 2 : step;
    for (std::size_t row = 0; row < static_cast<std::size_t>(order() - m); ++row)
        if (row % period != 0) std::fill_n(out + row * count, count, Real{0});
}

void JacobiBasis::thetaScalar(int m, std::span<const Elevation<double>> points, double* out) const {
    fillScalar(m, points, out);
}

void JacobiBasis::thetaScalar(int m, std::span<const Elevation<float>> points, float* out) const {
    fillScalar(m, points, out);
}

namespace {

class ScalarJacobi final : public Basis {
public:
    explicit ScalarJacobi(const JacobiBasis& basis)
        : Basis(basis.order(), {.condonShortley = basis.condonShortley()}), basis_(basis) {}

    std::string name() const override { return basis_.name(); }
    Inner inner() const override { return basis_.inner(); }
    bool has(int l, int m) const override { return basis_.has(l, m); }
    void theta(int m, std::span<const Elevation<double>> points, double* out) const override {
        basis_.thetaScalar(m, points, out);
    }
    void theta(int m, std::span<const Elevation<float>> points, float* out) const override {
        basis_.thetaScalar(m, points, out);
    }

private:
    const JacobiBasis& basis_;
};

}  // namespace

std::unique_ptr<Basis> scalarReference(const JacobiBasis& basis) {
    return std::make_unique<ScalarJacobi>(basis);
}

}  // namespace hshfit::bases
