#include <hshfit/material_library/learning.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/internal/vector_file.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/wording.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace hshfit::material_library {
namespace {

constexpr std::array<std::size_t, 9> ladder{5, 10, 15, 20, 30, 40, 60, 80, 120};
constexpr int leastWidth = 2, mostWidth = 16;
constexpr double worthIt = 1.03;      ///< error of fewer components over the least
constexpr double farAway = 3;         ///< times the median distance
constexpr std::size_t firstFew = 10;  ///< components that a distance is taken from
constexpr double nearEnough = 0.05;   ///< the distance up to which every material counts in full
constexpr int robustRounds = 2;
constexpr std::size_t mostPictures = 64;
constexpr std::size_t fewestFolds = 4, mostFolds = 10;  ///< parts by which distances are taken

/// Sums over vectors x with weights: of the weights, of x, and of x x^T.
struct Moments {
    double weight = 0;
    Eigen::VectorXd sum;
    Eigen::MatrixXd product;
};

/// Moments about `centre` of the vectors of each fold. Fold k has the materials whose number modulo
/// `folds` is k.
std::vector<Moments> momentsOf(const VectorSet& all, const std::vector<double>& weights,
                               const Eigen::VectorXd& centre, std::size_t folds) {
    const Eigen::Index terms = all.terms();
    std::vector<Moments> moments(
        folds, Moments{0, Eigen::VectorXd::Zero(terms), Eigen::MatrixXd::Zero(terms, terms)});
    std::vector<std::vector<Eigen::Index>> used(folds);
    all.eachBlock([&](const VectorBlock& block) {
        for (auto& one : used) one.clear();
        for (std::size_t v = 0; v < block.material.size(); ++v)
            used[block.material[v] % folds].push_back(static_cast<Eigen::Index>(v));
        for (std::size_t fold = 0; fold < folds; ++fold) {
            if (used[fold].empty()) continue;
            Eigen::VectorXd w(static_cast<Eigen::Index>(used[fold].size()));
            for (Eigen::Index k = 0; k < w.size(); ++k)
                w[k] = weights[block.material[static_cast<std::size_t>(
                    used[fold][static_cast<std::size_t>(k)])]];
            const Eigen::MatrixXd x = block.columns(Eigen::all, used[fold]).colwise() - centre;
            moments[fold].weight += w.sum();
            moments[fold].sum += x * w;
            moments[fold].product += x * w.asDiagonal() * x.transpose();
        }
    });
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

/// For each material, the largest distance of its channels from the first components of the other
/// folds: without[k] has the components of all folds but k.
std::vector<double> distancesOf(const VectorSet& all, const std::vector<Principal>& without) {
    std::vector<double> distances(all.materials(), 0.0);
    all.eachBlock([&](const VectorBlock& block) {
        for (Eigen::Index v = 0; v < block.count(); ++v) {
            const std::size_t material = block.material[static_cast<std::size_t>(v)];
            const Principal& principal = without[material % without.size()];
            const auto few = std::min<Eigen::Index>(static_cast<Eigen::Index>(firstFew),
                                                    principal.components.cols() / 4);
            const auto first = principal.components.leftCols(few);
            const Eigen::VectorXd centred = block.columns.col(v) - principal.mean;
            const double rest = (centred - first * (first.transpose() * centred)).norm();
            distances[material] = std::max(distances[material], rest);
        }
    });
    return distances;
}

struct Robust {
    Principal principal;
    std::vector<double> weights;
};

Moments sumWithout(const std::vector<Moments>& parts, std::size_t left) {
    Moments sum{0, Eigen::VectorXd::Zero(parts[0].sum.size()),
                Eigen::MatrixXd::Zero(parts[0].sum.size(), parts[0].sum.size())};
    for (std::size_t fold = 0; fold < parts.size(); ++fold) {
        if (fold == left) continue;
        sum.weight += parts[fold].weight;
        sum.sum += parts[fold].sum;
        sum.product += parts[fold].product;
    }
    return sum;
}

Eigen::VectorXd meanOf(const VectorSet& all) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(all.terms());
    all.eachBlock([&](const VectorBlock& block) { sum += block.columns.rowwise().sum(); });
    return sum / static_cast<double>(all.count());
}

/// Components of all, in which materials unlike the others count for less. The distance of a
/// material is from components of the other folds: its own would take it in.
Robust robustPrincipal(const VectorSet& all) {
    const std::size_t materials = all.materials(), folds = std::min(mostFolds, materials);
    Robust robust{{}, std::vector<double>(materials, 1.0)};
    const Eigen::VectorXd centre = meanOf(all);
    std::vector<Eigen::Index> vectors(folds, 0);
    for (std::size_t m = 0; m < materials; ++m)
        vectors[m % folds] += static_cast<Eigen::Index>(all.channels(m));
    for (int round = 0;; ++round) {
        const std::vector<Moments> parts = momentsOf(all, robust.weights, centre, folds);
        robust.principal = principalOf(sumWithout(parts, folds), centre, all.count());
        if (round == robustRounds || folds < fewestFolds) return robust;
        std::vector<Principal> without;
        for (std::size_t fold = 0; fold < folds; ++fold)
            without.push_back(
                principalOf(sumWithout(parts, fold), centre, all.count() - vectors[fold]));
        const std::vector<double> distances = distancesOf(all, without);
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
    const int bits = 1 + static_cast<int>(std::ceil(std::log2(largest / step + 1)));
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
    // The step of a file, in single precision, is not below the one that fits.
    return at(std::nextafter(static_cast<float>(std::exp2(high)), 1e30F));
}

/// Largest magnitude of each of the first coordinates over the materials that count.
std::vector<double> largestOf(const VectorSet& all, const Robust& robust, std::size_t components) {
    const auto count = std::min<Eigen::Index>(static_cast<Eigen::Index>(components),
                                              robust.principal.components.cols());
    std::vector<double> largest(static_cast<std::size_t>(count), 0.0);
    all.eachBlock([&](const VectorBlock& block) {
        const Eigen::MatrixXd a = robust.principal.components.leftCols(count).transpose() *
                                  (block.columns.colwise() - robust.principal.mean);
        for (Eigen::Index v = 0; v < a.cols(); ++v) {
            if (robust.weights[block.material[static_cast<std::size_t>(v)]] < 0.5) continue;
            for (Eigen::Index k = 0; k < count; ++k)
                largest[static_cast<std::size_t>(k)] =
                    std::max(largest[static_cast<std::size_t>(k)], std::abs(a(k, v)));
        }
    });
    return largest;
}

/// The squared error of a vector after rounding to the widths, with the best scale. `coordinates`
/// are along its first components, `square` is its squared length.
double storedSquare(const Eigen::VectorXd& coordinates, double square, const Widths& widths) {
    double least = square;
    for (unsigned code = 0; code < scaleCodes; ++code) {
        const double step = stepScale(code) * widths.step;
        double sum = square;
        for (std::size_t k = 0; k < widths.bits.size(); ++k) {
            if (widths.bits[k] == 0) continue;
            const double a = coordinates[static_cast<Eigen::Index>(k)],
                         most = std::exp2(widths.bits[k] - 1) - 1,
                         rest = a - step * std::clamp(std::round(a / step), -most, most);
            sum += rest * rest - a * a;
        }
        least = std::min(least, sum);
    }
    return std::max(least, 0.0);
}

/// Mean over vectors of the root mean square error after rounding, for each of several widths.
std::vector<double> storedErrors(const VectorSet& all, const Principal& principal,
                                 const std::vector<Widths>& several) {
    std::vector<double> means(several.size(), 0.0);
    all.eachBlock([&](const VectorBlock& block) {
        for (Eigen::Index v = 0; v < block.count(); ++v) {
            const Eigen::VectorXd centred = block.columns.col(v) - principal.mean,
                                  a = principal.components.transpose() * centred;
            for (std::size_t n = 0; n < several.size(); ++n)
                means[n] += std::sqrt(storedSquare(a, centred.squaredNorm(), several[n]));
        }
    });
    for (double& mean : means) mean /= static_cast<double>(all.count());
    return means;
}

std::size_t budgetOf(const LearnOptions& options) {
    const std::size_t channel = options.bytes / 3;
    if (channel < 2)
        throw UsageError(
            fmt::format("{} leaves no byte for a component: a channel needs 2 or more",
                        Setting{"LearnOptions::bytes", std::to_string(options.bytes)}));
    return 8 * (channel - 1) - scaleBits;
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
    basis.scaled = true;
    for (const double value : back(principal.mean)) basis.mean.push_back(static_cast<float>(value));
    for (std::size_t k = 0; k < widths.bits.size(); ++k) {
        if (widths.bits[k] == 0) continue;
        basis.widths.push_back(static_cast<std::uint8_t>(widths.bits[k]));
        for (const double value : back(principal.components.col(static_cast<Eigen::Index>(k))))
            basis.components.push_back(asHalf(value));
    }
    return basis;
}

/// The numbers of the materials that give the basis of a trial, and of the materials that it is
/// tried on.
struct Division {
    std::vector<std::size_t> fitted, held;
};

Division divisionOf(std::size_t materials, double heldOut) {
    Division division;
    const auto every = static_cast<std::size_t>(std::round(1 / std::max(heldOut, 1e-3)));
    for (std::size_t m = 0; m < materials; ++m)
        (every > 0 && m % every == every / 2 ? division.held : division.fitted).push_back(m);
    return division;
}

/// The mean FLIP of some of the materials `held` in a basis that they took no part in.
double unseenFlipOf(const LogSpace& space, const Basis& basis, const MaterialStore& store,
                    const VectorSet& held) {
    const std::size_t step = (held.materials() + mostPictures - 1) / mostPictures;
    std::vector<double> flips((held.materials() + step - 1) / step, 0.0);
    const Encoder encoder(basis, space);
    eachInParallel(flips.size(), [&](std::size_t n) {
        const Measured measured = store.measured(held.material(n * step));
        const LogMaterial material = measured.material();
        const LogBrdf before(material, measured.name),
            after(decode(basis, encoder.encode(material, basis.size())), measured.name);
        flips[n] = std::hypot(measured.error.flip, pictureError(before, after).flip.mean);
    });
    double sum = 0;
    for (const double one : flips) sum += one;
    return sum / static_cast<double>(flips.size());
}

/// Adds trials on the materials that are held out, and their errors in the basis of `components`
/// components. A 0 there becomes the number of the best trial.
void addTrials(const LogSpace& space, const MaterialStore& store, const VectorFile& vectors,
               const LearnOptions& options, bool pictures, std::size_t& components,
               LearnedBasis& learned) {
    Division division = divisionOf(store.size(), options.heldOut);
    if (division.held.empty() || division.fitted.size() < 2) {
        if (components == 0) components = ladder.back();
        return;
    }
    const VectorSet fitted(vectors, std::move(division.fitted)),
        held(vectors, std::move(division.held));
    const Robust robust = robustPrincipal(fitted);
    const std::vector<double> largest =
        largestOf(fitted, robust, std::max(ladder.back(), components));
    const auto widthsOf = [&](std::size_t count) {
        const auto first = static_cast<std::ptrdiff_t>(std::min(count, largest.size()));
        return widthsFor({largest.begin(), largest.begin() + first}, budgetOf(options));
    };
    std::vector<Widths> tried;
    for (const std::size_t count : ladder) {
        if (static_cast<Eigen::Index>(count) > robust.principal.components.cols()) break;
        learned.trials.push_back({.components = count});
        tried.push_back(widthsOf(count));
    }
    const std::vector<double> errors = storedErrors(held, robust.principal, tried);
    for (std::size_t n = 0; n < errors.size(); ++n) learned.trials[n].error = errors[n];
    if (components == 0) components = chosen(learned.trials);
    const Widths widths = widthsOf(components);
    learned.unseen = storedErrors(held, robust.principal, {widths})[0];
    if (pictures)
        learned.unseenFlip =
            unseenFlipOf(space, basisOf(space, robust.principal, widths), store, held);
}

}  // namespace

LearnedBasis learnBasis(const LogSpace& space, const MaterialStore& store,
                        const LearnOptions& options, bool pictures) {
    const VectorFile vectors(space, store);
    std::vector<std::size_t> numbers(store.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    const VectorSet all(vectors, std::move(numbers));
    if (all.count() < 2)
        throw UsageError(fmt::format(
            "a basis is learned from two channels or more that its terms hold, and these materials "
            "have {}: give more of them, or one in colours",
            all.count()));
    LearnedBasis learned;
    std::size_t components = options.components;
    addTrials(space, store, vectors, options, pictures, components, learned);
    const Robust robust = robustPrincipal(all);
    const Widths widths = widthsFor(largestOf(all, robust, components), budgetOf(options));
    learned.basis = basisOf(space, robust.principal, widths);
    learned.doubted = static_cast<std::size_t>(
        std::ranges::count_if(robust.weights, [](double weight) { return weight < 0.5; }));
    return learned;
}

}  // namespace hshfit::material_library
