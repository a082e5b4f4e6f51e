#include <hshfit/material_library/learning.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/pictures/picture_error.h>
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
constexpr double nearEnough = 0.05;   ///< the distance up to which every material counts in full
constexpr int robustRounds = 2;
constexpr std::size_t mostPictures = 64;
constexpr std::size_t fewestFolds = 4, mostFolds = 10;  ///< parts by which distances are taken

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

/// Sums over vectors x with weights: of the weights, of x, and of x x^T.
struct Moments {
    double weight = 0;
    Eigen::VectorXd sum;
    Eigen::MatrixXd product;
};

/// Moments of the columns of the materials that `counts` accepts, about `centre`.
template <class Counts>
Moments momentsOf(const Vectors& all, const std::vector<double>& weights,
                  const Eigen::VectorXd& centre, const Counts& counts) {
    std::vector<Eigen::Index> used;
    for (Eigen::Index v = 0; v < all.count(); ++v)
        if (counts(all.material[static_cast<std::size_t>(v)])) used.push_back(v);
    const Eigen::Index terms = all.columns.rows(), count = static_cast<Eigen::Index>(used.size());
    Eigen::VectorXd w(count);
    for (Eigen::Index k = 0; k < count; ++k)
        w[k] = weights[all.material[static_cast<std::size_t>(used[static_cast<std::size_t>(k)])]];
    Moments moments{w.sum(), Eigen::VectorXd::Zero(terms), Eigen::MatrixXd::Zero(terms, terms)};
    if (count == 0) return moments;
    const Eigen::MatrixXd x = all.columns(Eigen::all, used).colwise() - centre;
    moments.sum = x * w;
    moments.product = x * w.asDiagonal() * x.transpose();
    return moments;
}

/// Orthonormal components of vectors, the one with the largest spread first.
struct Principal {
    Eigen::VectorXd mean;
    Eigen::MatrixXd components;  ///< one a column
};

/// The components of `count` vectors by their moments about `centre`.
Principal principalOf(const Moments& moments, const Eigen::VectorXd& centre, Eigen::Index count) {
    const Eigen::VectorXd off = moments.sum / moments.weight;
    const Eigen::MatrixXd covariance = moments.product / moments.weight - off * off.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    const Eigen::Index most = std::max<Eigen::Index>(std::min(covariance.cols(), count - 1), 0);
    Principal principal{centre + off, solver.eigenvectors().rowwise().reverse().leftCols(most)};
    // The sign of a component is the sign of its largest number.
    for (auto component : principal.components.colwise()) {
        Eigen::Index largest = 0;
        component.cwiseAbs().maxCoeff(&largest);
        if (component[largest] < 0) component = -component;
    }
    return principal;
}

/// The largest distance of the channels of each material of `fold` from the first components.
void addDistances(const Vectors& all, const Principal& principal, std::size_t fold,
                  std::size_t folds, std::vector<double>& distances) {
    const Eigen::Index few = std::min<Eigen::Index>(static_cast<Eigen::Index>(firstFew),
                                                    principal.components.cols() / 4);
    const auto first = principal.components.leftCols(few);
    for (Eigen::Index v = 0; v < all.count(); ++v) {
        const std::size_t material = all.material[static_cast<std::size_t>(v)];
        if (material % folds != fold) continue;
        const Eigen::VectorXd centred = all.columns.col(v) - principal.mean;
        const double rest = (centred - first * (first.transpose() * centred)).norm();
        distances[material] = std::max(distances[material], rest);
    }
}

struct Robust {
    Principal principal;
    std::vector<double> weights;
};

/// Components of all, in which materials unlike the others count for less. The distance of a
/// material is from components of the other folds: its own would take it in.
Robust robustPrincipal(const Vectors& all, std::size_t materials) {
    Robust robust{{}, std::vector<double>(materials, 1.0)};
    const std::size_t folds = std::min(mostFolds, materials);
    const Eigen::VectorXd centre = all.columns.rowwise().mean();
    for (int round = 0;; ++round) {
        std::vector<Moments> parts;
        for (std::size_t fold = 0; fold < folds; ++fold)
            parts.push_back(momentsOf(all, robust.weights, centre,
                                      [&](std::size_t m) { return m % folds == fold; }));
        const auto without = [&](std::size_t left) {
            Moments sum{0, Eigen::VectorXd::Zero(centre.size()),
                        Eigen::MatrixXd::Zero(centre.size(), centre.size())};
            for (std::size_t fold = 0; fold < folds; ++fold) {
                if (fold == left) continue;
                sum.weight += parts[fold].weight;
                sum.sum += parts[fold].sum;
                sum.product += parts[fold].product;
            }
            return sum;
        };
        robust.principal = principalOf(without(folds), centre, all.count());
        if (round == robustRounds || folds < fewestFolds) return robust;
        std::vector<double> distances(materials, 0.0);
        for (std::size_t fold = 0; fold < folds; ++fold) {
            Eigen::Index others = 0;
            for (const std::size_t m : all.material) others += m % folds != fold ? 1 : 0;
            addDistances(all, principalOf(without(fold), centre, others), fold, folds, distances);
        }
        std::vector<double> sorted = distances;
        std::ranges::sort(sorted);
        const double bound = std::max(farAway * sorted[sorted.size() / 2], nearEnough);
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

/// The materials that give the basis of a trial, and those that it is tried on.
struct Division {
    std::vector<Measured> fitted, held;
};

Division divisionOf(std::span<const Measured> materials, double heldOut) {
    Division division;
    const auto every = static_cast<std::size_t>(std::round(1 / std::max(heldOut, 1e-3)));
    for (std::size_t m = 0; m < materials.size(); ++m)
        (every > 0 && m % every == every / 2 ? division.held : division.fitted)
            .push_back(materials[m]);
    return division;
}

/// The mean FLIP of materials in a basis that they took no part in.
double unseenFlipOf(const LogSpace& space, const Basis& basis, const std::vector<Measured>& held) {
    const std::size_t step = (held.size() + mostPictures - 1) / mostPictures;
    std::vector<double> flips(held.size(), 0.0);
    const Encoder encoder(basis, space);
    eachInParallel(held.size(), [&](std::size_t m) {
        if (m % step != 0) return;
        const LogMaterial material = held[m].material();
        const LogBrdf before(material, held[m].name),
            after(decode(basis, encoder.encode(material, basis.size())), held[m].name);
        flips[m] = held[m].error.flip + pictureError(before, after).flip.mean;
    });
    double sum = 0;
    for (const double one : flips) sum += one;
    return sum / static_cast<double>((held.size() + step - 1) / step);
}

/// Trials on the materials that are held out, and their errors in the basis of so many components;
/// 0 becomes those of the best trial.
void addTrials(const LogSpace& space, std::span<const Measured> materials,
               const LearnOptions& options, bool pictures, std::size_t& components,
               LearnedBasis& learned) {
    const Division division = divisionOf(materials, options.heldOut);
    if (division.held.empty() || division.fitted.size() < 2) {
        if (components == 0) components = ladder.back();
        return;
    }
    const Vectors all = vectorsOf(space, division.fitted), others = vectorsOf(space, division.held);
    const Robust robust = robustPrincipal(all, division.fitted.size());
    const auto widthsOf = [&](std::size_t count) {
        return widthsFor(largestOf(all, robust, count), budgetOf(options));
    };
    for (const std::size_t count : ladder) {
        if (static_cast<Eigen::Index>(count) > robust.principal.components.cols()) break;
        learned.trials.push_back({count, storedError(others, robust.principal, widthsOf(count))});
    }
    if (components == 0) components = chosen(learned.trials);
    const Widths widths = widthsOf(components);
    learned.unseen = storedError(others, robust.principal, widths);
    if (pictures)
        learned.unseenFlip =
            unseenFlipOf(space, basisOf(space, robust.principal, widths), division.held);
}

}  // namespace

LearnedBasis learnBasis(const LogSpace& space, std::span<const Measured> materials,
                        const LearnOptions& options, bool pictures) {
    const Vectors all = vectorsOf(space, materials);
    if (all.count() < 2)
        throw UsageError(fmt::format(
            "a basis is learned from two channels or more that its terms hold, and these materials "
            "have {}: give more of them, or one in colours",
            all.count()));
    LearnedBasis learned;
    std::size_t components = options.components;
    addTrials(space, materials, options, pictures, components, learned);
    const Robust robust = robustPrincipal(all, materials.size());
    const Widths widths = widthsFor(largestOf(all, robust, components), budgetOf(options));
    learned.basis = basisOf(space, robust.principal, widths);
    learned.doubted = static_cast<std::size_t>(
        std::ranges::count_if(robust.weights, [](double weight) { return weight < 0.5; }));
    return learned;
}

}  // namespace hshfit::material_library
