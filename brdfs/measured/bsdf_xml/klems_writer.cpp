#include <brdfs/measured/bsdf_xml/angle_basis.h>
#include <brdfs/measured/bsdf_xml/klems_writer.h>
#include <brdfs/measured/bsdf_xml/xml_frame.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace hshfit::brdfs {
namespace {

/// Steps of f that lie on rings and meridians in any case, as a matrix over patches has them.
struct PatchSteps {
    std::vector<double> heights = {};
    std::vector<KinkCurve> meridians = {};
};

PatchSteps stepsOf(std::vector<double> heights, const std::vector<KinkCurve>& curves) {
    PatchSteps steps{.heights = std::move(heights)};
    for (const KinkCurve& curve : curves) {
        if (curve.constant == 0 && curve.linear == 0 && curve.square == 0)
            steps.meridians.push_back(curve);
    }
    return steps;
}

/// A stretch and where it is cut.
std::vector<double> cutAt(double low, double high, const std::vector<double>& cuts) {
    std::vector<double> ends = {low, high};
    for (const double cut : cuts)
        if (cut > low && cut < high) ends.push_back(cut);
    std::ranges::sort(ends);
    return ends;
}

/// Patches, which contain (sign x, sign y) of directions. The sign is -1 for wi, because its patch
/// contains the direction in which the light goes.
class PatchCells {
public:
    PatchCells(const AngleBasis& basis, BsdfSide side, int sign, PatchSteps steps)
        : basis_(basis), side_(side), sign_(sign), steps_(std::move(steps)) {}

    /// Gauss-Legendre in cos(theta), with weight cos(theta), and in azimuth, between steps; in the
    /// pole's patch, a disc, azimuths are equispaced if no meridian cuts it.
    CellNodes nodes(std::size_t patch, int points) const {
        const Bounds bounds = boundsOf(patch);
        CellNodes nodes;
        const std::vector<double> heights = cutAt(bounds.low, bounds.high, steps_.heights);
        for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
            const double low = heights[k], high = heights[k + 1];
            const std::vector<double> cuts = azimuthCuts(bounds, (low + high) / 2);
            const double share = (high - low) * (high + low) /
                                 ((bounds.high - bounds.low) * (bounds.high + bounds.low));
            const GaussRule& rule = gaussLegendre(points);
            for (int a = 0; a < points; ++a) {
                const double z = low + (high - low) * 0.5 * (rule.nodes[a] + 1);
                addRing(nodes, z, share * rule.weights[a] * z / (high + low), bounds, cuts, points);
            }
        }
        return nodes;
    }

    Direction at(std::size_t patch, double u, double v) const {
        const Bounds bounds = boundsOf(patch);
        const double low = bounds.low * bounds.low, high = bounds.high * bounds.high;
        return directionAt(std::sqrt(low + (high - low) * u),
                           bounds.centre + bounds.width * (v - 0.5));
    }

private:
    struct Bounds {
        double low = 0, high = 1;  ///< of cos(theta)
        double centre = 0, width = 2 * pi;
        bool disc = false;
    };
    Bounds boundsOf(std::size_t patch) const {
        const AngleBasis::Ring& ring = basis_.rings()[basis_.ringOf(patch)];
        const double width = 2 * pi / static_cast<double>(ring.azimuths);
        return {.low = ring.upper < 90 ? std::cos(radians(ring.upper)) : 0,
                .high = std::cos(radians(ring.lower)),
                .centre = width * static_cast<double>(patch - ring.first),
                .width = width,
                .disc = ring.azimuths == 1};
    }

    Direction directionAt(double z, double phi) const {
        const double s = sign_ * std::sqrt((1 - z) * (1 + z));
        const double x = s * std::cos(phi);
        return {isFront(side_) ? -x : x, s * std::sin(phi), z};
    }

    /// Azimuths of a patch, ascending, at whose ends f has steps or the patch ends.
    std::vector<double> azimuthCuts(const Bounds& bounds, double z) const {
        std::vector<double> cuts;
        const double first = bounds.centre - bounds.width / 2;
        for (const KinkCurve& plane : steps_.meridians) {
            if (z < plane.low || z > plane.high) continue;
            // x cos(phi) + y sin(phi) = 0, in the file's plane
            const double x = isFront(side_) ? -plane.x : plane.x;
            const double phi = std::atan2(-x, plane.y);
            for (int turn = 0; turn < 2; ++turn) {
                const double from = phi + turn * pi - first;
                cuts.push_back(first + from - 2 * pi * std::floor(from / (2 * pi)));
            }
        }
        return cutAt(first, first + bounds.width, cuts);
    }

    void addRing(CellNodes& nodes, double z, double weight, const Bounds& bounds,
                 const std::vector<double>& cuts, int points) const {
        if (bounds.disc && cuts.size() == 2) {
            const int azimuths = 4 * points;
            for (int b = 0; b < azimuths; ++b)
                nodes.add(directionAt(z, cuts[0] + bounds.width * (b + 0.5) / azimuths),
                          weight / azimuths);
            return;
        }
        const GaussRule& rule = gaussLegendre(points);
        for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
            const double width = cuts[k + 1] - cuts[k];
            for (int b = 0; b < points; ++b)
                nodes.add(directionAt(z, cuts[k] + width * 0.5 * (rule.nodes[b] + 1)),
                          weight * rule.weights[b] / 2 * width / bounds.width);
        }
    }

    const AngleBasis& basis_;
    BsdfSide side_;
    int sign_;
    PatchSteps steps_;
};

CellSet cellsOf(std::size_t count, PatchCells patches) {
    const auto shared = std::make_shared<PatchCells>(std::move(patches));
    return {
        .count = count,
        .nodes = [shared](std::size_t cell, int points) { return shared->nodes(cell, points); },
        .at = [shared](std::size_t cell, double u, double v) { return shared->at(cell, u, v); }};
}

std::string matrixText(const CellAverages& averages, std::size_t columns) {
    std::string text = "\n";
    for (std::size_t k = 0; k < averages.values.size(); ++k) {
        text += fmt::format("{:.7g}", averages.values[k]);
        text += (k + 1) % columns == 0 ? '\n' : '\t';
    }
    return text;
}

/// The matrix of one block.
std::string blockText(const Brdf& brdf, BsdfSide side, const AngleBasis& basis,
                      const Parameters& parameters, const WriteOptions& options,
                      std::vector<std::string>& alterations) {
    const std::vector<double> weights = luminanceWeights(brdf, alterations);
    // A matrix is constant between steps that do not depend on the other direction: one point
    // between them is exact.
    const Direction pole{0, 0, 1};
    const bool matrix = dynamic_cast<const HasSteps*>(&brdf) != nullptr &&
                        squareLevelsOf(brdf) == 0 && brdf.lobes(pole).empty() &&
                        !brdf.kinks(pole).empty();
    PatchSteps incident, outgoing;
    if (matrix) {
        incident = stepsOf(brdf.kinks(pole), kinkCurvesOf(brdf, pole));
        outgoing = stepsOf(outgoingKinksOf(brdf, pole), outgoingKinkCurvesOf(brdf, pole));
    }
    const CellAverages averages = averageOverCells(
        brdf, weights, cellsOf(basis.patches(), {basis, side, -1, std::move(incident)}),
        cellsOf(basis.patches(), {basis, side, 1, std::move(outgoing)}),
        {.tolerance = parameters.number("tolerance"),
         .firstPoints = matrix ? 1 : 2,
         .evaluations = parameters.number("evaluations"),
         .progress = options.progress});
    reportUncertain(averages, alterations);
    return matrixText(averages, basis.patches());
}

std::vector<std::string> write(const Brdf& brdf, const std::string& path,
                               const Parameters& parameters, const WriteOptions& options) {
    const AngleBasis basis = standardAngleBases("LBNL/Klems Full").front();
    const BsdfXmlContent content{
        .material = brdf.name(), .structure = BsdfDocument::Structure::columns, .basis = &basis};
    return writeParts(
        content, partsOf(brdf, parameters),
        [&](const BsdfPart& part, std::vector<std::string>& alterations) {
            return blockText(*part.brdf, part.side, basis, parameters, options, alterations);
        },
        path, options);
}

}  // namespace

const Writer& bsdfKlemsWriter() {
    static const Writer writer{
        .name = "bsdf-klems",
        .help = "BSDF XML, matrix of 145 x 145 Klems patches, luminance",
        .extension = ".xml",
        .parameters = commonWriterParameters(),
        .write = write,
    };
    return writer;
}

}  // namespace hshfit::brdfs
