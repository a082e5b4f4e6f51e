#include <hshfit/transfer/windows.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/descend.h>
#include <hshfit/spelling.h>
#include <hshfit/transfer/internal/ring_transform.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace hshfit::inline transfer {
namespace {

constexpr std::array windowNames{"none", "hann", "lanczos", "bending"};

double squared(double x) {
    return x * x;
}

/// The factor of a window at x = pi l / n; 1 for the others.
double factorAt(Window window, double x) {
    if (window == Window::hann) return (1 + std::cos(x)) / 2;
    if (window == Window::lanczos) return x == 0 ? 1 : std::sin(x) / x;
    return 1;
}

/// A grid over the sphere on which sums of spherical harmonics are searched for their minimum.
class SphereScan {
public:
    SphereScan(int order, bool condonShortley)
        : basis_(bases::make("sh", order, {.condonShortley = condonShortley})),
          grid_(gridFor(order)),
          transform_(*basis_, grid_),
          values_(grid_.points()) {}

    double minimum(const double* c) {
        transform_.synthesise(c, values_.data());
        // The lowest node of the grid need not be next to the minimum: take several.
        std::vector<std::size_t> nodes = localMinima();
        const auto kept = std::min<std::size_t>(nodes.size(), 12);
        std::partial_sort(
            nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(kept), nodes.end(),
            [&](std::size_t one, std::size_t other) { return values_[one] < values_[other]; });
        double lowest = *std::min_element(values_.begin(), values_.end());
        for (std::size_t k = 0; k < kept; ++k) lowest = std::min(lowest, refined(c, nodes[k]));
        return lowest;
    }

private:
    static RingGrid gridFor(int order) {
        RingGrid grid;
        const int rings = 4 * order + 4;
        grid.azimuths = static_cast<std::size_t>(8 * order + 8);
        for (int r = 0; r < rings; ++r) {
            const double theta = pi * (r + 0.5) / rings;
            grid.elevations.push_back({std::cos(theta), 2 * squared(std::sin(0.5 * theta))});
        }
        grid.weights.assign(grid.elevations.size(), 1);
        return grid;
    }

    std::vector<std::size_t> localMinima() const {
        const std::size_t rings = grid_.elevations.size(), around = grid_.azimuths;
        std::vector<std::size_t> found;
        for (std::size_t r = 0; r < rings; ++r) {
            for (std::size_t j = 0; j < around; ++j) {
                const std::size_t node = r * around + j;
                const double value = values_[node];
                const bool lowest = value <= values_[r * around + (j + 1) % around] &&
                                    value <= values_[r * around + (j + around - 1) % around] &&
                                    (r == 0 || value <= values_[node - around]) &&
                                    (r + 1 == rings || value <= values_[node + around]);
                if (lowest) found.push_back(node);
            }
        }
        return found;
    }

    /// In the tangent plane of the node, so that the poles are points like others.
    double refined(const double* c, std::size_t node) {
        const double theta = pi * (static_cast<double>(node / grid_.azimuths) + 0.5) /
                             static_cast<double>(grid_.elevations.size());
        const double phi = 2 * pi * static_cast<double>(node % grid_.azimuths) /
                           static_cast<double>(grid_.azimuths);
        const Direction at = directionFromAngles(theta, phi);
        const Direction along = directionFromAngles(theta + 0.5 * pi, phi);
        const Direction across = directionFromAngles(0.5 * pi, phi + 0.5 * pi);
        const auto slots = static_cast<std::size_t>(basis_->slots());
        functions_.resize(slots);
        const auto value = [&](const std::vector<double>& x) {
            Direction d{at.x + x[0] * along.x + x[1] * across.x,
                        at.y + x[0] * along.y + x[1] * across.y,
                        at.z + x[0] * along.z + x[1] * across.z};
            const double length = std::sqrt(dot(d, d));
            d = {d.x / length, d.y / length, d.z / length};
            basis_->evaluate(d, functions_.data());
            return std::inner_product(functions_.begin(), functions_.end(), c, 0.0);
        };
        constexpr double any = std::numeric_limits<double>::infinity();
        const double step = pi / static_cast<double>(grid_.elevations.size());
        std::vector<double> x{0, 0};
        return descend(value, x, {{step, -any, any}, {step, -any, any}}, 14);
    }

    std::unique_ptr<Basis> basis_;
    RingGrid grid_;
    RingTransform transform_;
    std::vector<double> values_, functions_;
};

/// A window as one number: 0 is none, and more is stronger.
std::vector<double> factorsOf(Window window, int order, double strength) {
    if (strength == 0) return windowFactors(Window::none, order);
    if (window == Window::bending) return windowFactors(window, order, strength);
    return windowOfWidth(window, order, 1 / strength);
}

struct Search {
    std::span<const double> coefficients;
    int order;
    SphereScan& scan;
    std::vector<double> windowedCoefficients = {};

    std::size_t slots() const {
        return static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    }

    /// The lowest minimum of a channel, over the channel's mean.
    double lowest(const std::vector<double>& factors) {
        double result = std::numeric_limits<double>::infinity();
        windowedCoefficients.resize(slots());
        for (std::size_t first = 0; first < coefficients.size(); first += slots()) {
            for (std::size_t l = 0, i = 0; l < factors.size(); ++l) {
                for (; i < (l + 1) * (l + 1); ++i) {
                    windowedCoefficients[i] = coefficients[first + i] * factors[l];
                }
            }
            const double mean = coefficients[first] / std::sqrt(4 * pi);
            const double least = scan.minimum(windowedCoefficients.data());
            result = std::min(result, mean > 0 ? least / mean : least);
        }
        return result;
    }

    double change(const std::vector<double>& factors) const {
        double removed = 0, all = 0;
        for (std::size_t i = 0; i < coefficients.size(); ++i) {
            const auto l =
                static_cast<std::size_t>(std::sqrt(static_cast<double>(i % slots()) + 0.5));
            removed += squared(coefficients[i] * (1 - factors[l]));
            all += squared(coefficients[i]);
        }
        return all > 0 ? std::sqrt(removed / all) : 0;
    }
};

/// The weakest strength, to 1e-6, that is not negative: from a scale where it is strong enough.
double weakest(Search& search, Window window, double tolerance) {
    const int order = search.order;
    double low = 0, high = window == Window::bending ? 1e-6 : 1.0 / order;
    while (search.lowest(factorsOf(window, order, high)) < -tolerance) {
        low = high;
        high *= window == Window::bending ? 8 : 1.5;
        if (window != Window::bending && high >= 1) return 1;
        if (high > 1e12) return high;
    }
    for (int step = 0; step < 60 && high - low > 1e-6 * high; ++step) {
        const double middle = 0.5 * (low + high);
        (search.lowest(factorsOf(window, order, middle)) < -tolerance ? low : high) = middle;
    }
    return high;
}

}  // namespace

std::string_view windowName(Window window) {
    return windowNames[static_cast<std::size_t>(window)];
}

Window parseWindow(std::string_view name) {
    for (std::size_t k = 0; k < windowNames.size(); ++k) {
        if (windowNames[k] == name) return static_cast<Window>(k);
    }
    throw spelling::unknown("window", name, windowNames);
}

std::vector<double> windowFactors(Window window, int order, double lambda) {
    if (window != Window::bending) return windowOfWidth(window, order, order);
    std::vector<double> factors(static_cast<std::size_t>(order), 1.0);
    for (int l = 1; l < order; ++l) {
        factors[static_cast<std::size_t>(l)] = 1 / (1 + lambda * squared(l * (l + 1.0)));
    }
    return factors;
}

std::vector<double> windowOfWidth(Window window, int order, double width) {
    std::vector<double> factors(static_cast<std::size_t>(order), 1.0);
    if (window != Window::hann && window != Window::lanczos) return factors;
    for (int l = 1; l < order; ++l) {
        factors[static_cast<std::size_t>(l)] = l < width ? factorAt(window, pi * l / width) : 0;
    }
    return factors;
}

double minimumOnSphere(std::span<const double> coefficients, int order, bool condonShortley) {
    SphereScan scan(order, condonShortley);
    if (coefficients.size() != static_cast<std::size_t>(order) * static_cast<std::size_t>(order)) {
        throw UsageError(fmt::format("{} coefficients for {} bands, which have {}",
                                     coefficients.size(), order, order * order));
    }
    return scan.minimum(coefficients.data());
}

LeastNegative leastNegativeWindow(std::span<const double> coefficients, int order,
                                  bool condonShortley) {
    SphereScan scan(order, condonShortley);
    Search search{coefficients, order, scan};
    if (coefficients.empty() || coefficients.size() % search.slots() != 0) {
        throw UsageError(fmt::format("{} coefficients are no whole number of channels of {} bands",
                                     coefficients.size(), order));
    }
    for (std::size_t first = 0; first < coefficients.size(); first += search.slots()) {
        if (!(coefficients[first] >= 0)) {
            throw NumericError(fmt::format(
                "the mean of channel {} is {:g}; no window makes its function non-negative",
                first / search.slots(), coefficients[first] / std::sqrt(4 * pi)));
        }
    }
    constexpr double tolerance = 1e-9;
    LeastNegative best{.factors = windowFactors(Window::none, order)};
    best.minimum = search.lowest(best.factors);
    if (best.minimum >= -tolerance) return best;
    best.change = std::numeric_limits<double>::infinity();
    for (const Window window : {Window::hann, Window::lanczos, Window::bending}) {
        const double strength = weakest(search, window, tolerance);
        LeastNegative found{.window = window, .factors = factorsOf(window, order, strength)};
        (window == Window::bending ? found.lambda : found.width) =
            window == Window::bending ? strength : 1 / strength;
        found.change = search.change(found.factors);
        found.minimum = search.lowest(found.factors);
        if (found.change < best.change) best = found;
    }
    return best;
}

}  // namespace hshfit::inline transfer
