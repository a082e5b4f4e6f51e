#include <brdfs/measured/bsdf_xml/angle_basis.h>
#include <brdfs/measured/bsdf_xml/klems_writer.h>
#include <brdfs/measured/bsdf_xml/xml_frame.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::brdfs {
namespace {

/// Gauss-Legendre in cos(theta), with weight cos(theta), and in azimuth; the pole's patch is a disc
/// and has equispaced azimuths. `sign`: -1 for wi, whose patch is that of the direction in which
/// the light goes.
CellNodes patchNodes(const AngleBasis& basis, std::size_t patch, int points, BsdfSide side,
                     int sign) {
    const AngleBasis::Ring& ring = basis.rings()[basis.ringOf(patch)];
    const GaussRule& rule = gaussLegendre(points);
    const double low = ring.upper < 90 ? std::cos(radians(ring.upper)) : 0;
    const double high = std::cos(radians(ring.lower));
    const double step = 2 * pi / static_cast<double>(ring.azimuths);
    const double centre = step * static_cast<double>(patch - ring.first);
    const int azimuths = ring.azimuths == 1 ? 4 * points : points;
    CellNodes nodes;
    for (int a = 0; a < points; ++a) {
        const double z = low + (high - low) * 0.5 * (rule.nodes[a] + 1);
        const double weight = rule.weights[a] * z / (high + low);
        const double s = sign * std::sqrt((1 - z) * (1 + z));
        for (int b = 0; b < azimuths; ++b) {
            const double across = ring.azimuths == 1 ? (2 * b + 1.0) / azimuths - 1 : rule.nodes[b];
            const double share = ring.azimuths == 1 ? 1.0 / azimuths : rule.weights[b] / 2;
            const double phi = centre + 0.5 * step * across;
            const double x = s * std::cos(phi);
            nodes.add({side == BsdfSide::front ? -x : x, s * std::sin(phi), z}, weight * share);
        }
    }
    return nodes;
}

std::string matrixText(const CellAverages& averages, std::size_t columns) {
    std::string text = "\n";
    for (std::size_t k = 0; k < averages.values.size(); ++k) {
        text += fmt::format("{:.7g}", averages.values[k]);
        text += (k + 1) % columns == 0 ? '\n' : '\t';
    }
    return text;
}

std::vector<std::string> write(const Brdf& brdf, const std::string& path,
                               const Parameters& parameters, const WriteOptions& options) {
    const AngleBasis basis = standardAngleBases("LBNL/Klems Full").front();
    const BsdfSide side = sideOf(parameters);
    std::vector<std::string> alterations;
    const std::vector<double> weights = luminanceWeights(brdf, alterations);
    const auto cells = [&](int sign) {
        return CellSet{basis.patches(), [&basis, side, sign](std::size_t patch, int points) {
                           return patchNodes(basis, patch, points, side, sign);
                       }};
    };
    const CellAverages averages = averageOverCells(brdf, weights, cells(-1), cells(1),
                                                   {.tolerance = parameters.number("tolerance"),
                                                    .firstPoints = 2,
                                                    .mostPoints = 32,
                                                    .progress = options.progress});
    reportUncertain(averages, alterations);
    writeBsdfXml({.material = brdf.name(),
                  .side = side,
                  .structure = BsdfDocument::Structure::columns,
                  .basis = &basis,
                  .scatteringData = matrixText(averages, basis.patches())},
                 path, options);
    return alterations;
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
