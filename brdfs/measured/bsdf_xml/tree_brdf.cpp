#include <brdfs/measured/bsdf_xml/square.h>
#include <brdfs/measured/bsdf_xml/tree_brdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// Incident and outgoing coordinates change places.
constexpr std::array<int, 4> exchanged{2, 3, 0, 1};

}  // namespace

TreeBrdf::TreeBrdf(const BsdfDocument& document, BsdfSelection selection)
    : selection_(std::move(selection)) {
    addTree(document, *selection_.main);
    if (selection_.coloured()) {
        for (const BsdfBlock* block : selection_.colour) addTree(document, *block);
        channels_ = Channels::rgb();
    }
    if (!selection_.spectrum.empty()) {
        std::vector<double> nanometres;
        for (const BsdfBlock* block : selection_.spectrum) {
            nanometres.push_back(block->nanometres);
            if (block != selection_.main) addTree(document, *block);
        }
        channels_ = Channels::spectral(std::move(nanometres));
    }
    selection_.forgetBlocks();
    findLaws();
}

void TreeBrdf::addTree(const BsdfDocument& document, const BsdfBlock& block) {
    constexpr const char* square = "LBNL/Shirley-Chiu";
    if (!sameWord(block.squareBasis, square)) {
        throw document.error(block.offset, fmt::format("AngleBasis of a tensor tree is '{}', "
                                                       "expected {}",
                                                       block.squareBasis, square));
    }
    const int rank = document.structure() == BsdfDocument::Structure::tree3 ? 3 : 4;
    TensorTree& tree = trees_.emplace_back(document, block, rank);
    if (tree.corruptOffset() != 0 && selection_.corrupt.empty()) {
        selection_.corrupt =
            document.error(tree.corruptOffset(), "a value is NaN or infinite, expected a number")
                .what();
    }
    census_.values += tree.values().size();
    if (trees_.size() == 1) missing_.resize(tree.values().size());
    tree.forEachLeaf([&](const TensorTree::Leaf& leaf) {
        double& value = tree.values()[leaf.value];
        const bool unused = rank == 3 && leaf.corner[0] >= 0.5;
        // The half of the cube that has no directions.
        if (unused) {
            ++census_.belowHorizon;
        } else {
            census_.add(value);
        }
        if (std::isfinite(value) && value >= 0) return;
        if (trees_.size() == 1 && !std::isfinite(value)) missing_[leaf.value] = 1;
        value = 0;
    });
}

// The mirrored coordinates of a mirrored vector are coordinates of the square, so that laws of f
// are symmetries of the tree: reciprocity is T(p, q) = T(1 - q, 1 - p), because the incident square
// is the square of -wi.
void TreeBrdf::findLaws() {
    const bool isotropic = trees_[0].rank() == 3;
    const auto all = [&](const std::array<int, 4>& from, const std::array<bool, 4>& flipped) {
        return std::ranges::all_of(
            trees_, [&](const TensorTree& tree) { return tree.asymmetry(from, flipped) == 0; });
    };
    laws_.nonNegative = true;
    laws_.isotropic = isotropic;
    constexpr std::array<int, 4> same{0, 1, 2, 3};
    laws_.mirrorSymmetric =
        isotropic ? all(same, {false, false, true, false})
                  : all(same, {true, false, true, false}) && all(same, {false, true, false, true});
    laws_.reciprocal =
        !isotropic && !isTransmission(selection_.side) && all(exchanged, {true, true, true, true});
    if (trees_.size() > 1) return;
    const std::vector<double> reflectances = directionalReflectances();
    laws_.energyConserving =
        std::ranges::all_of(reflectances, [](double r) { return r <= 1 + roundingOfFiles; });
}

int TreeBrdf::squareLevels() const {
    int most = 0;
    for (const TensorTree& tree : trees_) most = std::max(most, tree.levels());
    return most;
}

std::size_t TreeBrdf::cells() const {
    const std::size_t side = std::size_t{1} << squareLevels();
    return trees_[0].rank() == 4 ? side * side : std::max<std::size_t>(side / 2, 1);
}

std::size_t TreeBrdf::cellOf(const Direction& wi) const {
    const std::size_t side = std::size_t{1} << squareLevels();
    const TensorTree::Point at = pointFor({0, 0, 1}, wi.x, wi.y);
    const auto step = [&](double u) {
        return std::min(static_cast<std::size_t>(std::max(u, 0.0) * static_cast<double>(side)),
                        side - 1);
    };
    return trees_[0].rank() == 4 ? step(at[1]) * side + step(at[0])
                                 : std::min(step(at[0]), cells() - 1);
}

Direction TreeBrdf::cellCentre(std::size_t cell) const {
    const auto side = static_cast<std::size_t>(1) << squareLevels();
    const auto centre = [&](std::size_t k) {
        return (static_cast<double>(k) + 0.5) / static_cast<double>(side);
    };
    if (trees_[0].rank() == 4) {
        const Direction to = directionFromSquare({centre(cell % side), centre(cell / side)});
        return {-selection_.fileX(to.x), -to.y, to.z};
    }
    const double sine = std::max(1 - 2 * centre(cell), 0.0);
    return {-selection_.fileX(sine), 0, std::sqrt((1 - sine) * (1 + sine))};
}

TensorTree::Point TreeBrdf::pointFor(const Direction& wo, double x, double y) const {
    // The direction in which the light goes.
    const double fromX = -selection_.fileX(x), fromY = -y;
    const double toX = selection_.fileX(wo.x), toY = wo.y;
    if (trees_[0].rank() == 4) {
        const SquarePoint p = squareFromDisc(fromX, fromY), q = squareFromDisc(toX, toY);
        return {p.u, p.v, q.u, q.v};
    }
    const double r = std::sqrt(fromX * fromX + fromY * fromY);
    const double cosine = r > 0 ? fromX / r : 1, sine = r > 0 ? fromY / r : 0;
    const SquarePoint q = squareFromDisc(cosine * toX + sine * toY, cosine * toY - sine * toX);
    // Normal incidence is in the last cell below the middle.
    return {std::min(0.5 * (1 - r), 0.5 - 1e-9), q.u, q.v, 0};
}

void TreeBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t count = channels_.count();
    if (!(wo.z > 0)) {
        std::fill_n(out, count * wi.count, 0.0);
        return;
    }
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) {
            for (std::size_t c = 0; c < count; ++c) out[c * wi.count + k] = 0;
            continue;
        }
        const TensorTree::Point point = pointFor(wo, wi.x[k], wi.y[k]);
        const double y = trees_[0].at(point);
        if (channels_.kind != Channels::Kind::rgb) {
            out[k] = y;
            for (std::size_t c = 1; c < count; ++c) out[c * wi.count + k] = trees_[c].at(point);
            continue;
        }
        const std::array<double, 3> rgb = rgbOfYuv(y, trees_[1].at(point), trees_[2].at(point));
        for (std::size_t c = 0; c < 3; ++c) out[c * wi.count + k] = asReflectance(rgb[c]);
    }
}

void TreeBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    for (std::size_t k = 0; k < wi.count; ++k) {
        const bool above = wo.z > 0 && wi.z[k] > 0;
        covered[k] = above && missing_[trees_[0].leafAt(pointFor(wo, wi.x[k], wi.y[k]))] == 0;
    }
}

std::vector<Lobe> TreeBrdf::lobes(const Direction& wo) const {
    constexpr std::size_t most = 8;
    const int side = 1 << std::min(trees_[0].levels(), 8);
    std::vector<double> values;
    double average = 0;
    for (int b = 0; b < side; ++b) {
        for (int a = 0; a < side; ++a) {
            const Direction wi = directionFromSquare({(a + 0.5) / side, (b + 0.5) / side});
            values.push_back(trees_[0].at(pointFor(wo, wi.x, wi.y)));
            average += values.back() / (side * side);
        }
    }
    std::vector<Lobe> lobes;
    while (lobes.size() < most) {
        const auto peak = std::ranges::max_element(values);
        if (!(*peak > 4 * average)) break;
        const auto cell = static_cast<int>(peak - values.begin());
        const int a = cell % side, b = cell / side;
        // Half a cell is 1 / side across the disc.
        lobes.push_back({.about = Lobe::About::axis,
                         .width = 1.0 / side,
                         .axis = directionFromSquare({(a + 0.5) / side, (b + 0.5) / side})});
        for (int y = std::max(b - 1, 0); y <= std::min(b + 1, side - 1); ++y) {
            for (int x = std::max(a - 1, 0); x <= std::min(a + 1, side - 1); ++x) {
                values[static_cast<std::size_t>(y * side + x)] = 0;
            }
        }
    }
    return lobes;
}

std::vector<double> TreeBrdf::directionalReflectances() const {
    std::vector<double> averages = trees_[0].averagesOverLast(2);
    if (trees_[0].rank() == 3 && averages.size() > 1) averages.resize(averages.size() / 2);
    for (double& average : averages) average *= pi;
    return averages;
}

// The coarser grid is a part of the finer: the cell with the same corner.
bool TreeBrdf::addReflection(const TreeBrdf& reflection) {
    const int rank = trees_[0].rank();
    if (reflection.trees_[0].rank() != rank) return false;
    const std::vector<double> own = directionalReflectances(),
                              other = reflection.directionalReflectances();
    const auto sideOf = [&](const TensorTree& tree, const std::vector<double>& cells) {
        return rank == 4 ? std::size_t{1} << tree.levels() : cells.size();
    };
    const std::size_t mine = sideOf(trees_[0], own), theirs = sideOf(reflection.trees_[0], other),
                      side = std::max(mine, theirs);
    double most = 0;
    for (std::size_t v = 0; v < (rank == 4 ? side : 1); ++v)
        for (std::size_t u = 0; u < side; ++u)
            most = std::max(most, own[v * mine / side * mine + u * mine / side] +
                                      other[v * theirs / side * theirs + u * theirs / side]);
    withReflection_ = most;
    laws_.energyConserving = laws_.energyConserving && most <= 1 + roundingOfFiles;
    return true;
}

std::vector<Axis> TreeBrdf::axes() const {
    // Cells along the x axis, from the middle of the square to its rim.
    const int cells = std::max(1 << trees_[0].levels() >> 1, 1);
    const auto theta = [&](double cell) { return degrees(std::asin(cell / cells)); };
    Axis axis{"theta_i",  "degrees",          static_cast<std::size_t>(cells),
              theta(0.5), theta(cells - 0.5), 0};
    for (int k = 1; k < cells; ++k) {
        axis.largestGap = std::max(axis.largestGap, theta(k + 0.5) - theta(k - 0.5));
    }
    std::vector<Axis> axes{axis, axis};
    axes[1].name = "theta_o";
    return axes;
}

std::vector<Fact> TreeBrdf::facts() const {
    std::vector<Fact> facts = selection_.facts;
    const TensorTree& tree = trees_[0];
    facts.emplace_back("levels", static_cast<std::int64_t>(tree.levels()));
    facts.emplace_back("leaves", static_cast<std::int64_t>(tree.values().size()));
    facts.emplace_back("negative_values", static_cast<std::int64_t>(census_.negative));
    facts.emplace_back("nan_values", static_cast<std::int64_t>(census_.notANumber));
    facts.emplace_back("infinite_values", static_cast<std::int64_t>(census_.infinite));
    const std::vector<double> reflectances = directionalReflectances();
    const auto [least, most] = std::ranges::minmax(reflectances);
    const bool through = isTransmission(selection_.side);
    const char* const share = through ? "transmittance" : "reflectance";
    facts.emplace_back(fmt::format("least_directional_{}", share), least);
    facts.emplace_back(fmt::format("largest_directional_{}", share), most);
    if (withReflection_)
        facts.emplace_back("largest_reflectance_and_transmittance", *withReflection_);
    if (tree.rank() == 4) {
        double mean = 0;
        for (const double r : reflectances) mean += r / static_cast<double>(reflectances.size());
        facts.emplace_back(fmt::format("mean_{}", share), mean);
        if (through) return facts;
        facts.emplace_back("reciprocity_defect",
                           tree.asymmetry(exchanged, {true, true, true, true}));
    }
    return facts;
}

}  // namespace hshfit::brdfs
