#include <hshfit/transfer/convolution.h>

#include <hshfit/bases/sh.h>
#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::inline transfer {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<double> clampedCosineOf(int order, double /*parameter*/) {
    return clampedCosine(order);
}

constexpr std::array table{
    Kernel{"clamped-cosine", "max(0, cos a)", "", -infinity, infinity, false, clampedCosineOf},
    Kernel{"phong", "max(0, cos a)^s", "exponent s, 0 to 1e9", 0, 1e9, false, phongLobe},
    Kernel{"heat", "the Gaussian of the sphere: exp(-l (l + 1) sigma^2 / 2)",
           "sigma in radians, 0 to 100", 0, 100, true, heatKernel},
    Kernel{"von-mises-fisher", "kappa exp(kappa cos a) / (4 pi sinh kappa)", "kappa, 0 to 1e12", 0,
           1e12, true, vonMisesFisher},
};

std::vector<double> bands(int order) {
    if (order < 1) throw UsageError(fmt::format("order {} of a kernel; it starts at 1", order));
    return std::vector<double>(static_cast<std::size_t>(order), 0.0);
}

void requireInside(std::string_view kernel, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw UsageError(fmt::format("{} as the parameter of the kernel '{}' is outside {:g} .. {:g}",
                                 value, kernel, least, most));
}

constexpr int panelNodes = 24;
constexpr std::size_t mostPanels = 100000;
/// Phase of P_l over a panel: with 12, 24 nodes integrate it and h to rounding.
constexpr double panelPhase = 12;

/// Quadrature of h over the angle: nodes that resolve it, with h sin(a) d a at each.
class AnglePanels {
public:
    AnglePanels(const AngleFunction& h, const AngleOptions& options, double widest)
        : h_(h), rule_(gaussLegendre(panelNodes)), widest_(widest) {
        std::vector<double> ends = startEnds(options);
        for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
            total_ += absoluteIntegral(ends[k], ends[k + 1]);
        }
        tolerance_ = options.tolerance;
        for (std::size_t k = 0; k + 1 < ends.size(); ++k) split(ends[k], ends[k + 1], 0);
    }

    std::vector<double> angles, products;

private:
    /// Panels begin in octaves towards angle 0, where lobes are.
    static std::vector<double> startEnds(const AngleOptions& options) {
        const double last = std::clamp(options.last, 0.0, pi);
        std::vector<double> ends{0, last};
        for (int k = 1; k <= 40; ++k) ends.push_back(std::ldexp(last, -k));
        for (const double end : options.breaks) {
            if (end > 0 && end < last) ends.push_back(end);
        }
        std::sort(ends.begin(), ends.end());
        ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
        return ends;
    }

    void sample(double a, double b) {
        for (int k = 0; k < panelNodes; ++k) {
            nodes_[k] = 0.5 * (a + b) + 0.5 * (b - a) * rule_.nodes[k];
        }
        h_(nodes_, values_.data());
        for (int k = 0; k < panelNodes; ++k) {
            if (!std::isfinite(values_[k])) {
                throw NumericError(
                    fmt::format("the kernel is {} at {:g} degrees; a kernel has finite values",
                                values_[k], degrees(nodes_[k])));
            }
        }
    }

    double absoluteIntegral(double a, double b) {
        sample(a, b);
        double sum = 0;
        for (int k = 0; k < panelNodes; ++k) {
            sum += 0.5 * (b - a) * rule_.weights[k] * std::abs(values_[k]) * std::sin(nodes_[k]);
        }
        return sum;
    }

    /// The largest of the last four Legendre coefficients of the panel's values.
    double tail() const {
        std::array<double, panelNodes> coefficients{};
        for (int k = 0; k < panelNodes; ++k) {
            double before = 0, p = 1;
            const double x = rule_.nodes[k], weight = rule_.weights[k] * values_[k];
            for (int l = 0; l < panelNodes; ++l) {
                coefficients[l] += (l + 0.5) * weight * p;
                const double next = ((2 * l + 1) * x * p - l * before) / (l + 1);
                before = p;
                p = next;
            }
        }
        double largest = 0;
        for (int l = panelNodes - 4; l < panelNodes; ++l) {
            largest = std::max(largest, std::abs(coefficients[l]));
        }
        return largest;
    }

    void split(double a, double b, int depth) {
        const double middle = 0.5 * (a + b);
        const bool shortest = depth >= 60 || !(middle > a && middle < b);
        if (b - a <= widest_ || shortest) {
            sample(a, b);
            // Rounding of the values leaves a tail of its own.
            double largest = 0;
            for (const double value : values_) largest = std::max(largest, std::abs(value));
            const double area = (b - a) * std::sin(middle);
            if (shortest || tail() * area <= tolerance_ * total_ || tail() <= 4e-15 * largest) {
                keep(a, b);
                return;
            }
        }
        split(a, middle, depth + 1);
        split(middle, b, depth + 1);
    }

    void keep(double a, double b) {
        if (angles.size() >= mostPanels * panelNodes) {
            throw NumericError(
                fmt::format("the kernel is not resolved by {} panels of its angle, "
                            "of which the last begins at {:g} degrees",
                            mostPanels, degrees(a)));
        }
        for (int k = 0; k < panelNodes; ++k) {
            angles.push_back(nodes_[k]);
            products.push_back(0.5 * (b - a) * rule_.weights[k] * values_[k] * std::sin(nodes_[k]));
        }
    }

    const AngleFunction& h_;
    const GaussRule& rule_;
    double widest_, total_ = 0, tolerance_ = 0;
    std::array<double, panelNodes> nodes_{}, values_{};
};

}  // namespace

std::span<const Kernel> kernelCatalog() {
    return table;
}

std::vector<double> kernelMultipliers(std::string_view name, int order, double parameter) {
    std::string known;
    for (const Kernel& kernel : table) {
        if (kernel.name == name) return kernel.multipliers(order, parameter);
        known += fmt::format("{}{}", known.empty() ? "" : ", ", kernel.name);
    }
    throw UsageError(fmt::format("unknown kernel '{}'; known: {}", name, known));
}

std::vector<double> clampedCosine(int order) {
    std::vector<double> lambda = bands(order);
    // c = l! / (2^l (l/2)!^2) for even l.
    double c = 1, sign = -1;
    for (int l = 0; l < order; l += 2) {
        if (l > 0) c *= (l - 1.0) / l;
        lambda[static_cast<std::size_t>(l)] = 2 * pi * sign * c / ((l + 2.0) * (l - 1.0));
        sign = -sign;
    }
    if (order > 1) lambda[1] = 2 * pi / 3;
    return lambda;
}

std::vector<double> phongLobe(int order, double exponent) {
    requireInside("phong", exponent, 0, 1e9);
    std::vector<double> lambda = bands(order);
    lambda[0] = 2 * pi / (exponent + 1);
    if (order > 1) lambda[1] = 2 * pi / (exponent + 2);
    for (int l = 2; l < order; ++l) {
        const auto k = static_cast<std::size_t>(l);
        lambda[k] = lambda[k - 2] * ((exponent - l + 2) / (exponent + l + 1));
    }
    return lambda;
}

std::vector<double> heatKernel(int order, double sigma) {
    requireInside("heat", sigma, 0, 100);
    std::vector<double> lambda = bands(order);
    for (int l = 0; l < order; ++l) {
        lambda[static_cast<std::size_t>(l)] = std::exp(-0.5 * l * (l + 1.0) * sigma * sigma);
    }
    return lambda;
}

std::vector<double> vonMisesFisher(int order, double kappa) {
    requireInside("von-mises-fisher", kappa, 0, 1e12);
    std::vector<double> lambda = bands(order);
    lambda[0] = 1;
    // Below this lambda_2 = kappa^2 / 15 is no normal number.
    if (kappa < 1e-150) {
        if (order > 1) lambda[1] = kappa / 3;
        return lambda;
    }
    // Where the start is, lambda_l is e^-45 of lambda_{order-1} or less: its choice does not
    // matter.
    const double start = std::sqrt(static_cast<double>(order) * order + 90 * kappa) + 40;
    double above = 0, here = 1;
    for (auto l = static_cast<long>(start); l > 0; --l) {
        double below = above + (2 * static_cast<double>(l) + 1) / kappa * here;
        if (l < order) lambda[static_cast<std::size_t>(l)] = here;
        above = here;
        here = below;
        // Values are relative to the last one, and shrink as it grows.
        if (here > 1e100) {
            for (long k = l; k < order; ++k) lambda[static_cast<std::size_t>(k)] /= here;
            above /= here;
            here = 1;
        }
    }
    for (int l = 1; l < order; ++l) lambda[static_cast<std::size_t>(l)] /= here;
    for (double& value : lambda) {
        if (std::abs(value) < std::numeric_limits<double>::min()) value = 0;
    }
    return lambda;
}

std::vector<double> multipliersOf(const AngleFunction& h, int order, const AngleOptions& options) {
    std::vector<double> lambda = bands(order);
    const AnglePanels panels(h, options, panelPhase / order);
    const auto basis = bases::makeSh(order, {});
    constexpr std::size_t block = 1024;
    std::vector<Elevation<double>> points;
    std::vector<double> theta;
    for (std::size_t first = 0; first < panels.angles.size(); first += block) {
        const std::size_t count = std::min(block, panels.angles.size() - first);
        points.clear();
        for (std::size_t k = 0; k < count; ++k) {
            const double sine = std::sin(0.5 * panels.angles[first + k]);
            points.push_back({std::cos(panels.angles[first + k]), 2 * sine * sine});
        }
        theta.resize(count * lambda.size());
        basis->theta(0, points, theta.data());
        for (std::size_t l = 0; l < lambda.size(); ++l) {
            double sum = 0;
            for (std::size_t k = 0; k < count; ++k) {
                sum += panels.products[first + k] * theta[l * count + k];
            }
            lambda[l] += sum;
        }
    }
    // theta holds sqrt((2l + 1) / 2) P_l.
    for (std::size_t l = 0; l < lambda.size(); ++l) {
        lambda[l] *= 2 * pi / std::sqrt(static_cast<double>(l) + 0.5);
    }
    return lambda;
}

void convolve(std::span<double> coefficients, std::span<const double> multipliers) {
    const auto order =
        static_cast<std::size_t>(std::sqrt(static_cast<double>(coefficients.size()) + 0.5));
    if (order * order != coefficients.size()) {
        throw UsageError(fmt::format(
            "{} coefficients are no whole number of bands; n bands have n^2", coefficients.size()));
    }
    if (multipliers.size() < order) {
        throw UsageError(fmt::format("{} multipliers for {} bands; each band needs one",
                                     multipliers.size(), order));
    }
    for (std::size_t l = 0, i = 0; l < order; ++l) {
        for (; i < (l + 1) * (l + 1); ++i) coefficients[i] *= multipliers[l];
    }
}

std::vector<double> zonalCoefficients(std::span<const double> multipliers) {
    std::vector<double> zonal;
    for (std::size_t l = 0; l < multipliers.size(); ++l) {
        zonal.push_back(multipliers[l] * std::sqrt((2 * static_cast<double>(l) + 1) / (4 * pi)));
    }
    return zonal;
}

}  // namespace hshfit::inline transfer
