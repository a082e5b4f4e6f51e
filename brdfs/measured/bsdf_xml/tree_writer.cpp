#include <brdfs/measured/bsdf_xml/square.h>
#include <brdfs/measured/bsdf_xml/tree_writer.h>
#include <brdfs/measured/bsdf_xml/xml_frame.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

Direction seenFrom(BsdfSide side, const Direction& d, int sign) {
    return {isFront(side) ? -sign * d.x : sign * d.x, sign * d.y, d.z};
}

/// Cell u + side v of the square.
CellNodes squareNodes(std::size_t cell, int levels, int points, BsdfSide side, int sign) {
    const GaussRule& rule = gaussLegendre(points);
    const std::size_t steps = std::size_t{1} << levels;
    const double width = 1 / static_cast<double>(steps);
    const auto at = [&](std::size_t step, int k) {
        return width * (static_cast<double>(step) + 0.5 * (rule.nodes[k] + 1));
    };
    CellNodes nodes;
    for (int a = 0; a < points; ++a) {
        for (int b = 0; b < points; ++b) {
            const Direction d = directionFromSquare({at(cell % steps, a), at(cell / steps, b)});
            nodes.add(seenFrom(side, d, sign), rule.weights[a] * rule.weights[b] / 4);
        }
    }
    return nodes;
}

Direction squarePoint(std::size_t cell, int levels, double u, double v, BsdfSide side, int sign) {
    const std::size_t steps = std::size_t{1} << levels;
    const double width = 1 / static_cast<double>(steps);
    return seenFrom(side,
                    directionFromSquare({width * (static_cast<double>(cell % steps) + u),
                                         width * (static_cast<double>(cell / steps) + v)}),
                    sign);
}

/// Cell of the first coordinate of rank 3, (1 - sin(theta_i)) / 2: a line of directions that go
/// towards azimuth 0, with weight sin(theta_i).
CellNodes radiusNodes(std::size_t cell, int levels, int points, BsdfSide side) {
    const GaussRule& rule = gaussLegendre(points);
    const double width = std::ldexp(2.0, -levels);
    CellNodes nodes;
    double sum = 0;
    for (int a = 0; a < points; ++a) {
        const double inwards = width * (static_cast<double>(cell) + 0.5 * (rule.nodes[a] + 1));
        const double r = 1 - inwards;
        const Direction d{r, 0, std::sqrt(inwards * (2 - inwards))};
        nodes.add(seenFrom(side, d, -1), rule.weights[a] * r);
        sum += rule.weights[a] * r;
    }
    for (double& weight : nodes.weight) weight /= sum;
    return nodes;
}

/// A point of that line: equal stretches of `u` have equal weight.
Direction radiusPoint(std::size_t cell, int levels, double u, BsdfSide side) {
    const double width = std::ldexp(2.0, -levels);
    const double most = 1 - width * static_cast<double>(cell), least = most - width;
    const double r = std::sqrt(least * least + (most - least) * (most + least) * u);
    return seenFrom(side, {r, 0, std::sqrt((1 - r) * (1 + r))}, -1);
}

/// Prints a full grid of averages as a tree.
class TreePrinter {
public:
    TreePrinter(const CellAverages& averages, int rank, int levels, double prune)
        : values_(averages.values), rank_(rank), levels_(levels), prune_(prune) {}

    std::string text() const { return fmt::format("\n{}\n", textOf(build(0, {}))); }

private:
    struct Built {
        bool leaf = true;
        double mean = 0, least = 0, most = 0;
        std::string text = {};  ///< of a branch
    };

    static std::string textOf(const Built& node) {
        return node.leaf ? fmt::format("{{ {:.7g} }}", node.mean) : node.text;
    }

    double valueAt(const std::array<std::size_t, 4>& cell) const {
        const std::size_t steps = std::size_t{1} << levels_;
        if (rank_ == 4) {
            return values_[(cell[2] + steps * cell[3]) * steps * steps + cell[0] + steps * cell[1]];
        }
        // The upper half of the first coordinate has no directions.
        if (cell[0] >= steps / 2) return 0;
        return values_[(cell[1] + steps * cell[2]) * (steps / 2) + cell[0]];
    }

    Built build(int level, const std::array<std::size_t, 4>& corner) const {
        if (level == levels_) {
            const double value = valueAt(corner);
            return {.mean = value, .least = value, .most = value};
        }
        const std::size_t half = std::size_t{1} << (levels_ - level - 1);
        const std::size_t children = std::size_t{1} << rank_;
        std::vector<Built> parts;
        Built whole{.least = HUGE_VAL, .most = -HUGE_VAL};
        bool leaves = true;
        for (std::size_t k = 0; k < children; ++k) {
            std::array<std::size_t, 4> at = corner;
            for (int i = 0; i < rank_; ++i) at[i] += (k >> i & 1) != 0 ? half : 0;
            parts.push_back(build(level + 1, at));
            whole.mean += parts[k].mean / static_cast<double>(children);
            whole.least = std::min(whole.least, parts[k].least);
            whole.most = std::max(whole.most, parts[k].most);
            leaves = leaves && parts[k].leaf;
        }
        whole.leaf = leaves && whole.most - whole.least <= prune_ * whole.mean;
        if (!whole.leaf) whole.text = branchText(parts, leaves);
        return whole;
    }

    // Sixteen leaves are a grid, whose last coordinate changes fastest: bits in reverse order.
    std::string branchText(const std::vector<Built>& parts, bool leaves) const {
        std::string text = "{";
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (!leaves) {
                text += '\n';
                text += textOf(parts[k]);
                continue;
            }
            std::size_t child = 0;
            for (int i = 0; i < rank_; ++i) child |= (k >> (rank_ - 1 - i) & 1) << i;
            text += fmt::format(" {:.7g}", parts[child].mean);
        }
        return text + (leaves ? " }" : "\n}");
    }

    const std::vector<double>& values_;
    int rank_, levels_;
    double prune_;
};

/// The tree of one block.
std::string blockText(const Brdf& brdf, BsdfSide side, int rank, const Parameters& parameters,
                      const WriteOptions& options, std::vector<std::string>& alterations) {
    const int levels = static_cast<int>(std::lround(parameters.number("levels")));
    const std::vector<double> weights = luminanceWeights(brdf, alterations);
    const std::size_t steps = std::size_t{1} << levels;
    const auto square = [=](int sign) {
        return CellSet{
            .count = steps * steps,
            .nodes = [=](std::size_t cell,
                         int points) { return squareNodes(cell, levels, points, side, sign); },
            .at = [=](std::size_t cell, double u,
                      double v) { return squarePoint(cell, levels, u, v, side, sign); }};
    };
    const CellSet radius{
        .count = steps / 2,
        .nodes = [=](std::size_t cell,
                     int points) { return radiusNodes(cell, levels, points, side); },
        .at = [=](std::size_t cell, double u,
                  double) { return radiusPoint(cell, levels, u, side); }};
    const CellAverages averages =
        averageOverCells(brdf, weights, rank == 4 ? square(-1) : radius, square(1),
                         {.tolerance = parameters.number("tolerance"),
                          .firstPoints = 1,
                          .evaluations = parameters.number("evaluations"),
                          .progress = options.progress});
    reportUncertain(averages, alterations);
    return TreePrinter(averages, rank, levels, parameters.number("prune")).text();
}

std::vector<std::string> writeTree(const Brdf& brdf, const std::string& path,
                                   const Parameters& parameters, const WriteOptions& options) {
    const std::vector<BsdfPart> parts = partsOf(brdf, parameters);
    // A file has one rank.
    const bool isotropic = std::ranges::all_of(
        parts, [](const BsdfPart& part) { return part.brdf->laws().isotropic; });
    const int rank = isotropic ? 3 : 4;
    if (rank == 4 && parameters.number("levels") > 6) {
        throw UsageError(fmt::format("{}: levels={} is too fine for an anisotropic BRDF, at most 6",
                                     brdf.name(), parameters.number("levels")));
    }
    const BsdfXmlContent content{
        .material = brdf.name(),
        .structure = isotropic ? BsdfDocument::Structure::tree3 : BsdfDocument::Structure::tree4};
    return writeParts(
        content, parts,
        [&](const BsdfPart& part, std::vector<std::string>& alterations) {
            return blockText(*part.brdf, part.side, rank, parameters, options, alterations);
        },
        path, options);
}

}  // namespace

const Writer& bsdfTreeWriter() {
    static const Writer writer = [] {
        std::vector<Parameter> parameters = commonWriterParameters();
        parameters.push_back({.name = "levels",
                              .help = "2^levels cells along the square; at most 6 if anisotropic",
                              .fallback = 5,
                              .min = 1,
                              .max = 8});
        parameters.push_back({.name = "prune",
                              .help = "spread, relative to the mean, below which cells are merged",
                              .fallback = 0.01,
                              .min = 0,
                              .max = 1});
        return Writer{.name = "bsdf-tree",
                      .help = "BSDF XML, tensor tree of rank 3 (isotropic) or 4, luminance",
                      .extension = ".xml",
                      .parameters = std::move(parameters),
                      .write = writeTree};
    }();
    return writer;
}

}  // namespace hshfit::brdfs
