#include <hshfit/material_library/learning.h>

#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/wording.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::material_library {
namespace {

constexpr std::array<std::size_t, 9> ladder{5, 10, 15, 20, 30, 40, 60, 80, 120};
constexpr double margin = 4.0 / 3;  ///< of a width beyond the largest coordinate
constexpr int leastWidth = 2, mostWidth = 16;
constexpr double worthIt = 1.03;      ///< error of fewer components over the least
constexpr double farAway = 3;         ///< times the median distance
constexpr std::size_t firstFew = 10;  ///< components that a distance is taken from
constexpr int robustRounds = 2;

/// Channels of materials as columns of d = L^T c, and the material of each.
struct Vectors {
    Eigen::MatrixXd columns;
    std::vector<std::size_t> material;

    Eigen::Index count() const { return columns.cols(); }
};

Vectors vectorsOf(const LogSpace& space, std::span<const Measured> materials) {
    const Eigen::MatrixXd& lower = space.samples().lower;
    const auto terms = lower.rows();
    Vectors all;
    for (std::size_t m = 0; m < materials.size(); ++m)
        all.material.insert(all.material.end(), materials[m].channels(), m);
    all.columns.resize(terms, static_cast<Eigen::Index>(all.material.size()));
    Eigen::Index column = 0;
    for (const Measured& material : materials)
        for (std::size_t c = 0; c < material.channels(); ++c)
            all.columns.col(column++) =
                lower.transpose() *
                Eigen::Map<const Eigen::VectorXf>(
                    material.exponents.data() + c * static_cast<std::size_t>(terms), terms)
                    .cast<double>();
    return all;
}

/// Orthonormal components of the columns, the one with the largest spread first.
struct Principal {
    Eigen::VectorXd mean;
    Eigen::MatrixXd components;  ///< one a column
};

Principal principalOf(const Vectors& all, const std::vector<double>& weights) {
    Eigen::VectorXd w(all.count());
    for (Eigen::Index v = 0; v < all.count(); ++v)
        w[v] = weights[all.material[static_cast<std::size_t>(v)]];
    w /= w.sum();
    Principal principal{all.columns * w, {}};
    const Eigen::MatrixXd centred = all.columns.colwise() - principal.mean;
    const Eigen::MatrixXd covariance = centred * w.asDiagonal() * centred.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    const Eigen::Index most = std::min(covariance.cols(), all.count() - 1);
    principal.components = solver.eigenvectors().rowwise().reverse().leftCols(most);
    // The sign of a component is that of its largest number.
    for (auto component : principal.components.colwise()) {
        Eigen::Index largest = 0;
        component.cwiseAbs().maxCoeff(&largest);
        if (component[largest] < 0) component = -component;
    }
    return principal;
}

/// Distance of each material from the space of the first few components.
std::vector<double> distancesOf(const Vectors& all, const Principal& principal,
                                std::size_t materials) {
    const Eigen::Index few = std::min<Eigen::Index>(static_cast<Eigen::Index>(firstFew),
                                                    principal.components.cols() / 4);
    const auto first = principal.components.leftCols(few);
    const Eigen::MatrixXd centred = all.columns.colwise() - principal.mean;
    const Eigen::MatrixXd rest = centred - first * (first.transpose() * centred);
    std::vector<double> square(materials, 0.0);
    for (Eigen::Index v = 0; v < all.count(); ++v) {
        double& most = square[all.material[static_cast<std::size_t>(v)]];
        most = std::max(most, rest.col(v).squaredNorm());
    }
    for (double& value : square) value = std::sqrt(value);
    return square;
}

struct Robust {
    Principal principal;
    std::vector<double> weights;
};

Robust robustPrincipal(const Vectors& all, std::size_t materials) {
    Robust robust{{}, std::vector<double>(materials, 1.0)};
    for (int round = 0;; ++round) {
        robust.principal = principalOf(all, robust.weights);
        if (round == robustRounds) return robust;
        const std::vector<double> distances = distancesOf(all, robust.principal, materials);
        std::vector<double> sorted = distances;
        std::ranges::sort(sorted);
        const double bound = farAway * sorted[sorted.size() / 2];
        for (std::size_t m = 0; m < materials; ++m)
            robust.weights[m] = distances[m] > bound ? std::pow(bound / distances[m], 2) : 1.0;
    }
}

/// Bits of one component for coordinates up to `largest`; 0 where one step is more.
int widthFor(double largest, double step) {
    if (largest * 2 < step) return 0;
    const int bits = 1 + static_cast<int>(std::ceil(std::log2(margin * largest / step + 1)));
    return std::clamp(bits, leastWidth, mostWidth);
}

struct Widths {
    std::vector<int> bits;  ///< 0: the component is left out
    double step = 1;
};

/// The smallest step with which the components fit into `budget` bits.
Widths widthsFor(const std::vector<double>& largest, std::size_t budget) {
    const auto at = [&](double step) {
        Widths widths{{}, step};
        for (const double value : largest) widths.bits.push_back(widthFor(value, step));
        return widths;
    };
    const auto fits = [&](const Widths& widths) {
        std::size_t sum = 0;
        for (const int bits : widths.bits) sum += static_cast<std::size_t>(bits);
        return sum <= budget;
    };
    const double most = *std::ranges::max_element(largest);
    // Beyond 16 bits nothing is gained.
    double low = std::log2(std::max(most, 1e-6)) - 14, high = low + 16;
    if (fits(at(std::exp2(low)))) return at(std::exp2(low));
    for (int step = 0; step < 40; ++step) {
        const double middle = (low + high) / 2;
        (fits(at(std::exp2(middle))) ? high : low) = middle;
    }
    return at(static_cast<float>(std::exp2(high)));
}

/// Largest magnitude of each coordinate over the materials that count.
std::vector<double> largestOf(const Vectors& all, const Robust& robust, std::size_t components) {
    const auto count = std::min<Eigen::Index>(static_cast<Eigen::Index>(components),
                                              robust.principal.components.cols());
    const Eigen::MatrixXd a = robust.principal.components.leftCols(count).transpose() *
                              (all.columns.colwise() - robust.principal.mean);
    std::vector<double> largest(static_cast<std::size_t>(count), 0.0);
    for (Eigen::Index v = 0; v < a.cols(); ++v) {
        if (robust.weights[all.material[static_cast<std::size_t>(v)]] < 0.5) continue;
        for (Eigen::Index k = 0; k < count; ++k)
            largest[static_cast<std::size_t>(k)] =
                std::max(largest[static_cast<std::size_t>(k)], std::abs(a(k, v)));
    }
    return largest;
}

/// Mean over vectors of the root mean square error after rounding to the widths.
double storedError(const Vectors& all, const Principal& principal, const Widths& widths) {
    double sum = 0;
    for (Eigen::Index v = 0; v < all.count(); ++v) {
        Eigen::VectorXd rest = all.columns.col(v) - principal.mean;
        for (std::size_t k = 0; k < widths.bits.size(); ++k) {
            if (widths.bits[k] == 0) continue;
            const auto component = principal.components.col(static_cast<Eigen::Index>(k));
            const double most = std::exp2(widths.bits[k] - 1) - 1;
            const double q = std::clamp(std::round(component.dot(rest) / widths.step), -most, most);
            rest -= q * widths.step * component;
        }
        sum += rest.norm();
    }
    return sum / static_cast<double>(all.count());
}

std::size_t budgetOf(const LearnOptions& options) {
    const std::size_t channel = options.bytes / 3;
    if (channel < 2)
        throw UsageError(
            fmt::format("{} leaves no byte for a component: a channel needs 2 or more",
                        Setting{"LearnOptions::bytes", std::to_string(options.bytes)}));
    return 8 * (channel - 1);
}

std::vector<ComponentsTrial> trialsOf(const LogSpace& space, std::span<const Measured> materials,
                                      const LearnOptions& options) {
    std::vector<Measured> fitted, held;
    const auto every = static_cast<std::size_t>(std::round(1 / std::max(options.heldOut, 1e-3)));
    for (std::size_t m = 0; m < materials.size(); ++m)
        (every > 0 && m % every == every / 2 ? held : fitted).push_back(materials[m]);
    if (held.empty() || fitted.size() < 2) return {};
    const Vectors all = vectorsOf(space, fitted), others = vectorsOf(space, held);
    const Robust robust = robustPrincipal(all, fitted.size());
    std::vector<ComponentsTrial> trials;
    for (const std::size_t components : ladder) {
        if (static_cast<Eigen::Index>(components) > robust.principal.components.cols()) break;
        const Widths widths = widthsFor(largestOf(all, robust, components), budgetOf(options));
        trials.push_back({components, storedError(others, robust.principal, widths)});
    }
    return trials;
}

std::size_t chosen(const std::vector<ComponentsTrial>& trials) {
    if (trials.empty()) return ladder.back();
    const double least = std::ranges::min_element(trials, {}, &ComponentsTrial::error)->error;
    for (const ComponentsTrial& trial : trials)
        if (trial.error <= worthIt * least) return trial.components;
    return trials.back().components;
}

double asHalf(double value) {
    return static_cast<float>(Imath::half(static_cast<float>(value)));
}

Basis basisOf(const LogSpace& space, const Principal& principal, const Widths& widths) {
    const Eigen::MatrixXd& lower = space.samples().lower;
    const auto back = [&](Eigen::VectorXd d) {
        lower.transpose().triangularView<Eigen::Upper>().solveInPlace(d);
        return d;
    };
    Basis basis;
    basis.step = widths.step;
    for (const double value : back(principal.mean)) basis.mean.push_back(static_cast<float>(value));
    for (std::size_t k = 0; k < widths.bits.size(); ++k) {
        if (widths.bits[k] == 0) continue;
        basis.widths.push_back(static_cast<std::uint8_t>(widths.bits[k]));
        for (const double value : back(principal.components.col(static_cast<Eigen::Index>(k))))
            basis.components.push_back(asHalf(value));
    }
    return basis;
}

}  // namespace

LearnedBasis learnBasis(const LogSpace& space, std::span<const Measured> materials,
                        const LearnOptions& options) {
    const Vectors all = vectorsOf(space, materials);
    if (all.count() < 2)
        throw UsageError(
            "a basis is learned from two channels or more: give more materials, or one in colours");
    LearnedBasis learned;
    std::size_t components = options.components;
    learned.trials = trialsOf(space, materials, options);
    if (components == 0) components = chosen(learned.trials);
    for (const ComponentsTrial& trial : learned.trials)
        if (learned.unseen == 0 || trial.components <= components) learned.unseen = trial.error;
    const Robust robust = robustPrincipal(all, materials.size());
    const Widths widths = widthsFor(largestOf(all, robust, components), budgetOf(options));
    learned.basis = basisOf(space, robust.principal, widths);
    learned.doubted = static_cast<std::size_t>(
        std::ranges::count_if(robust.weights, [](double weight) { return weight < 0.5; }));
    return learned;
}

}  // namespace hshfit::material_library
